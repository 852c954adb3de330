#include "pliant/app/batch/batch_folder.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/geometry/io/readable_file.h"
#include "pliant/math/error.h"
#include "pliant/scene/yaml/yaml_tree.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

std::size_t count_in(const YamlNode& root, const std::string& key) {
  const YamlNode* node = root.find(key);
  std::size_t count = 0;
  if (node == nullptr || std::sscanf(node->text.c_str(), "%zu", &count) != 1) {
    throw InputError(fmt::format("{}: '{}' is missing: choose another folder or give --overwrite",
                                 root.place().text(), key));
  }
  return count;
}

/// In the notes: how many bytes of a table count.
std::string bytes_key(std::size_t table) {
  return table == 0 ? "bytes" : fmt::format("bytes_{}", table);
}

}  // namespace

BatchFolder::BatchFolder(std::string folder, const Inputs& inputs, std::vector<Table> tables,
                         Start start)
    : folder_(std::move(folder)), inputs_(inputs), tables_(std::move(tables)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) {
    throw InputError(fmt::format("cannot make folder '{}': {}", folder_, error.message()));
  }
  lock_ = FolderLock(folder_);
  const bool is_there = fs::exists(fs::symlink_status(scenes()));
  if (is_there && start == Start::kNew) {
    throw InputError(scenes() +
                     " is there already; choose another folder, give --overwrite, or --resume to "
                     "go on with it");
  }
  if (is_there && start == Start::kResume) {
    take_up();
  } else {
    begin();
  }
}

void BatchFolder::take_up() {
  const YamlNode root = read_yaml_file(notes());
  const YamlNode* hash = root.find("inputs");
  const bool is_same = hash != nullptr && hash->text == inputs_.hash &&
                       count_in(root, "first") == inputs_.begin &&
                       count_in(root, "last") == inputs_.end;
  if (!is_same) {
    throw InputError(notes() +
                     ": --resume: the scenes there are of another scene, table, rows or options: "
                     "choose another folder or give --overwrite");
  }
  finished_ = count_in(root, "finished");
  for (const Table& table : tables_) {
    const std::size_t bytes = count_in(root, bytes_key(rows_.size()));
    rows_.push_back(GrowingFile::open(path_of(table)));
    if (rows_.back().size() < bytes) {
      throw InputError(path_of(table) + " is shorter than it was left: give --overwrite");
    }
    rows_.back().cut(bytes);
  }
}

void BatchFolder::begin() {
  for (const Table& table : tables_) {
    if (fs::exists(fs::symlink_status(path_of(table))) && !fs::is_regular_file(notes())) {
      throw InputError(path_of(table) +
                       " was not written by a batch, whose batch.yaml would be beside it: move it "
                       "away, or choose another folder");
    }
  }
  for (const Table& table : tables_) {
    rows_.push_back(GrowingFile::replace(path_of(table), table.header));
  }
  publish(0);
}

void BatchFolder::add(const std::vector<std::string>& rows) {
  try {
    for (std::size_t t = 0; t < rows_.size(); ++t) {
      rows_[t].append(rows[t]);
      rows_[t].sync();
    }
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}; {} scenes are finished, and --resume goes on with the others",
                                 error.what(), finished_));
  }
}

void BatchFolder::publish(std::size_t finished) {
  finished_ = finished;
  std::string text = fmt::format(
      "# What `pliant run --resume` goes on from.\n"
      "inputs: \"{}\"\nfirst: {}\nlast: {}\nfinished: {}\n",
      inputs_.hash, inputs_.begin, inputs_.end, finished_);
  for (std::size_t t = 0; t < rows_.size(); ++t) {
    text += fmt::format("{}: {}\n", bytes_key(t), rows_[t].size());
  }
  write_file_atomically(notes(), text);
  fs::remove(state());
}

std::string BatchFolder::unfinished() const {
  return fs::is_regular_file(state()) ? read_bytes(state()) : "";
}

void BatchFolder::keep_unfinished(const std::string& bytes) const {
  write_file_atomically(state(), bytes);
}

}  // namespace pliant
