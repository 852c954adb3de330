#include "pliant/app/batch/batch_checkpoint.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <cstdio>

#include "pliant/core/checkpoint_file.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

std::string hash_line(std::string_view bytes) {
  return fmt::format("{:016x}\n", XXH3_64bits(bytes.data(), bytes.size()));
}

/// Each text behind its length.
void add_text(const std::string& text, std::string& bytes) {
  bytes += fmt::format("{}\n", text.size());
  bytes += text;
}

[[noreturn]] void refuse_state(const std::string& where) {
  throw InputError(where + ": it is damaged: remove it, and its scenes begin anew");
}

std::uint64_t next_number(std::string_view& bytes, const std::string& where) {
  const std::string line(bytes.substr(0, bytes.find('\n')));
  unsigned long long number = 0;
  if (std::sscanf(line.c_str(), "%llu", &number) != 1 || line.size() == bytes.size()) {
    refuse_state(where);
  }
  bytes.remove_prefix(line.size() + 1);
  return number;
}

std::string next_text(std::string_view& bytes, const std::string& where) {
  const std::uint64_t size = next_number(bytes, where);
  if (size > bytes.size()) refuse_state(where);
  std::string text(bytes.substr(0, size));
  bytes.remove_prefix(size);
  return text;
}

}  // namespace

std::string bytes_of(std::uint64_t steps, const std::vector<SceneText>& texts, const Batch& batch) {
  std::string bytes = fmt::format("{}\n{}\n", steps, texts.size());
  for (int s = 0; s < batch.size(); ++s) {
    const SceneText& text = texts[static_cast<std::size_t>(s)];
    add_text(text.rows, bytes);
    add_text(text.contacts, bytes);
    bytes += fmt::format("{}\n", text.warnings.size());
    for (const std::string& warning : text.warnings) add_text(warning, bytes);
    const bool is_there = batch.refusal(s).empty();
    add_text(is_there ? state_bytes({batch.world(s).save(), {}}) : "", bytes);
  }
  return hash_line(bytes) + bytes;
}

UnfinishedGroup unfinished_group(const std::string& bytes, const std::string& where) {
  std::string_view rest = bytes;
  constexpr std::size_t kHash = 17;
  if (rest.size() < kHash || hash_line(rest.substr(kHash)) != rest.substr(0, kHash)) {
    refuse_state(where);
  }
  rest.remove_prefix(kHash);
  UnfinishedGroup group;
  group.steps = next_number(rest, where);
  const std::uint64_t scenes = next_number(rest, where);
  for (std::uint64_t s = 0; s < scenes; ++s) {
    SceneText text;
    text.rows = next_text(rest, where);
    text.contacts = next_text(rest, where);
    const std::uint64_t warnings = next_number(rest, where);
    for (std::uint64_t w = 0; w < warnings; ++w) text.warnings.insert(next_text(rest, where));
    group.texts.push_back(std::move(text));
    group.states.push_back(next_text(rest, where));
  }
  return group;
}

void restore(const UnfinishedGroup& group, const std::string& where, Batch& batch) {
  for (int s = 0; s < batch.size(); ++s) {
    const std::string& state = group.states[static_cast<std::size_t>(s)];
    if (state.empty() != !batch.refusal(s).empty()) refuse_state(where);
    if (!state.empty()) batch.world(s).load(state_of(state, where).checkpoint);
  }
}

}  // namespace pliant
