#include "pliant/scene/robot/urdf_reader.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <mutex>

#include "pliant/math/error.h"
#include "pliant/scene/yaml/text_file.h"

namespace pliant {
namespace {

/// Collects what urdfdom would print. The library has one output for the whole process.
class ParserMessages final : public console_bridge::OutputHandler {
 public:
  ParserMessages() : lock_(mutex()), previous_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~ParserMessages() override { console_bridge::useOutputHandler(previous_); }

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) {
      text_ += (text_.empty() ? "" : "; ") + text;
    }
  }
  const std::string& text() const { return text_; }

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  std::lock_guard<std::mutex> lock_;
  console_bridge::OutputHandler* previous_;
  std::string text_;
};

/// urdfdom reads XML by a library of its own, which takes other characters for a bare '&'.
void check_names(const ParsedUrdf& parsed, const std::string& where) {
  const auto check = [&](const auto& made, const auto& read, const char* kind) {
    for (const auto& [name, part] : made) {
      if (read.count(name) > 0) continue;
      throw InputError(
          fmt::format("{}: not valid URDF: the name of a {} is read as '{}' and otherwise: use "
                      "letters, digits, '_' and '-', or write '&' as '&amp;'",
                      where, kind, name));
    }
  };
  check(parsed.model->links_, parsed.xml.lines.links, "link");
  check(parsed.model->joints_, parsed.xml.lines.joints, "joint");
}

}  // namespace

ParsedUrdf parse_urdf(const std::string& urdf, const std::string& where) {
  if (urdf.size() > kMaxUrdfBytes) {
    throw InputError(fmt::format("{}: URDF is longer than {} bytes", where, kMaxUrdfBytes));
  }
  if (urdf.find_first_not_of(" \t\r\n") == std::string::npos) {
    throw InputError(where + ": the URDF is empty");
  }
  check_text(urdf, where);
  ParsedUrdf parsed;
  parsed.xml = check_urdf_xml(urdf, where);
  std::string messages;
  try {
    const ParserMessages capture;
    parsed.model = urdf::parseURDF(parsed.xml.text);
    messages = capture.text();
  } catch (const std::exception& error) {
    messages = error.what();
  }
  // urdfdom logs errors that it goes on from, such as a wrong collision shape, which would then be
  // missing without a word.
  if (parsed.model == nullptr || !messages.empty()) {
    throw InputError(fmt::format("{}: not valid URDF: {}", where,
                                 messages.empty() ? "it cannot be parsed" : messages));
  }
  check_names(parsed, where);
  return parsed;
}

}  // namespace pliant
