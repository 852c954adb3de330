#include "pliant/geometry/io/number_stream.h"

#include <fmt/format.h>

#include <charconv>
#include <cstring>
#include <utility>

#include "pliant/math/error.h"

namespace pliant {
namespace {
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
}  // namespace

NumberStream::NumberStream(std::string path, std::string_view bytes)
    : path_(std::move(path)), bytes_(bytes) {}

std::string_view NumberStream::line() {
  const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
  std::string_view text = bytes_.substr(at_, end - at_);
  at_ = std::min(end + 1, bytes_.size());
  ++line_;
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

void NumberStream::skip_past_line(std::string_view text) {
  while (at_ < bytes_.size()) {
    if (line() == text) return;
  }
  fail(fmt::format("the file ends before '{}'", text));
}

bool NumberStream::at_end() {
  skip_space();
  return at_ >= bytes_.size();
}

void NumberStream::skip_space() {
  for (; at_ < bytes_.size(); ++at_) {
    if (comments_ && bytes_[at_] == '#') {
      while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
      if (at_ == bytes_.size()) return;
    }
    if (!is_space(bytes_[at_])) return;
    if (bytes_[at_] == '\n') ++line_;
  }
}

std::string_view NumberStream::word(const char* wanted) {
  skip_space();
  const std::size_t first = at_;
  while (at_ < bytes_.size() && !is_space(bytes_[at_])) ++at_;
  if (first == at_) fail(fmt::format("the file ends where {} should be", wanted));
  return bytes_.substr(first, at_ - first);
}

template <typename Number>
Number NumberStream::raw() {
  if (bytes_.size() - at_ < sizeof(Number)) fail("the file ends too early");
  Number number;
  std::memcpy(&number, bytes_.data() + at_, sizeof(Number));
  at_ += sizeof(Number);
  return number;
}

template <typename Number>
Number NumberStream::parsed(const char* wanted) {
  const std::string_view text = word(wanted);
  const char* first = text.data() + (text.size() > 1 && text[0] == '+' ? 1 : 0);
  const char* last = text.data() + text.size();
  Number number{};
  const auto [end, error] = std::from_chars(first, last, number);
  if (error != std::errc() || end != last) {
    fail(fmt::format("'{}' should be {}", text.substr(0, 40), wanted));
  }
  return number;
}

std::int64_t NumberStream::integer32() {
  return binary_ ? raw<std::int32_t>() : parsed<std::int64_t>("a whole number");
}

std::int64_t NumberStream::integer64() {
  return binary_ ? raw<std::int64_t>() : parsed<std::int64_t>("a whole number");
}

double NumberStream::real() { return binary_ ? raw<double>() : parsed<double>("a number"); }

std::int64_t NumberStream::count(const char* what, std::int64_t most, bool wide) {
  const std::int64_t number = wide ? integer64() : integer32();
  if (number < 0 || number > most) {
    fail(fmt::format("the number of {} is {}: allowed is [0, {}]", what, number, most));
  }
  return number;
}

void NumberStream::fail(const std::string& what) const {
  throw InputError(binary_ ? fmt::format("mesh '{}', byte {}: {}", path_, at_, what)
                           : fmt::format("mesh '{}', line {}: {}", path_, line_, what));
}

}  // namespace pliant
