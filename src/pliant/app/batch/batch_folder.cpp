#include "pliant/app/batch/batch_folder.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

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
  const bool is_there = fs::exists(fs::symlink_status(table()));
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
  const std::size_t bytes = count_in(root, "bytes");
  rows_.emplace(GrowingFile::open(table()));
  if (rows_->size() < bytes) {
    throw InputError(table() + " is shorter than it was left: give --overwrite");
  }
  rows_->cut(bytes);
}

void BatchFolder::begin(const std::string& header) {
  if (fs::exists(fs::symlink_status(table())) && !fs::is_regular_file(notes())) {
    throw InputError(table() +
                     " was not written by a batch, whose batch.yaml would be beside it: move it "
                     "away, or choose another folder");
  }
  rows_.emplace(GrowingFile::replace(table(), header));
  publish(0);
}

void BatchFolder::add(const std::string& rows) {
  try {
    rows_->append(rows);
    rows_->sync();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}; {} scenes are finished, and --resume goes on with the others",
                                 error.what(), finished_));
  }
}

void BatchFolder::publish(std::size_t finished) {
  finished_ = finished;
  write_file_atomically(
      notes(), fmt::format("# What `pliant run --resume` goes on from.\n"
                           "inputs: \"{}\"\nfirst: {}\nlast: {}\nfinished: {}\nbytes: {}\n",
                           inputs_.hash, inputs_.begin, inputs_.end, finished_, rows_->size()));
}

}  // namespace pliant
