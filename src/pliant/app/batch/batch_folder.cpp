#include "pliant/app/batch/batch_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "pliant/geometry/io/atomic_file.h"
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

}  // namespace

BatchFolder::BatchFolder(std::string folder, const Inputs& inputs, const std::string& header,
                         Start start)
    : folder_(std::move(folder)), inputs_(inputs) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) {
    throw InputError(fmt::format("cannot make folder '{}': {}", folder_, error.message()));
  }
  lock_ = FolderLock(folder_);
  const bool is_there = fs::exists(table());
  if (is_there && start == Start::kNew) {
    throw InputError(table() +
                     " is there already; choose another folder, give --overwrite, or --resume to "
                     "go on with it");
  }
  if (is_there && start == Start::kResume) {
    take_up();
  } else {
    begin(header);
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
  bytes_ = count_in(root, "bytes");
  std::error_code error;
  const std::size_t size = fs::file_size(table(), error);
  if (error || size < bytes_) {
    throw InputError(table() + " is shorter than it was left: give --overwrite");
  }
  fs::resize_file(table(), bytes_, error);
  if (error) throw InputError(fmt::format("cannot write '{}': {}", table(), error.message()));
}

void BatchFolder::begin(const std::string& header) {
  write_file_atomically(table(), header);
  bytes_ = header.size();
  publish(0);
}

void BatchFolder::add(const std::string& rows) {
  const int file = open(table().c_str(), O_WRONLY | O_APPEND | O_NOFOLLOW | O_CLOEXEC);
  std::size_t done = 0;
  while (file >= 0 && done < rows.size()) {
    const ssize_t now = write(file, rows.data() + done, rows.size() - done);
    if (now < 0 && errno != EINTR) break;
    if (now > 0) done += static_cast<std::size_t>(now);
  }
  const bool is_written = file >= 0 && done == rows.size() && fdatasync(file) == 0;
  const int why = errno;
  if (file >= 0) close(file);
  if (is_written) {
    bytes_ += rows.size();
    return;
  }
  // Whole scenes only, also on a full disk.
  std::error_code ignored;
  fs::resize_file(table(), bytes_, ignored);
  throw InputError(
      fmt::format("cannot write '{}': {}; {} scenes are finished, and --resume goes on "
                  "with the others",
                  table(), std::strerror(why), finished_));
}

void BatchFolder::publish(std::size_t finished) {
  finished_ = finished;
  write_file_atomically(
      notes(), fmt::format("# What `pliant run --resume` goes on from.\n"
                           "inputs: \"{}\"\nfirst: {}\nlast: {}\nfinished: {}\nbytes: {}\n",
                           inputs_.hash, inputs_.begin, inputs_.end, finished_, bytes_));
}

}  // namespace pliant
