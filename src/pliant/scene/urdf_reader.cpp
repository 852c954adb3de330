#include "pliant/scene/urdf_reader.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <mutex>

#include "pliant/math/error.h"
#include "pliant/scene/text_file.h"

namespace pliant {
namespace {

constexpr int kMaxXmlDepth = 200;

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

/// Index after `end`, searched from `begin`; the text's size when it is not there.
std::size_t after(const std::string& text, const std::string& end, std::size_t begin) {
  const std::size_t found = text.find(end, begin);
  return found == std::string::npos ? text.size() : found + end.size();
}

/// Index after the `>` of the tag at `i`; one within quotes does not end it.
std::size_t end_of_tag(const std::string& text, std::size_t i) {
  char quote = 0;
  for (; i < text.size(); ++i) {
    if (quote != 0) {
      if (text[i] == quote) quote = 0;
    } else if (text[i] == '"' || text[i] == '\'') {
      quote = text[i];
    } else if (text[i] == '>') {
      return i + 1;
    }
  }
  return i;
}

/// The XML parser recurses into elements and would overflow the stack.
void check_xml_depth(const std::string& text, const std::string& where) {
  int depth = 0;
  for (std::size_t i = text.find('<'); i < text.size(); i = text.find('<', i)) {
    if (text.compare(i, 4, "<!--") == 0) {
      i = after(text, "-->", i);
    } else if (text.compare(i, 2, "<?") == 0 || text.compare(i, 2, "<!") == 0) {
      i = after(text, ">", i);
    } else {
      const bool closes = text.compare(i, 2, "</") == 0;
      i = end_of_tag(text, i);
      const bool is_empty = text.compare(i - 2, 2, "/>") == 0;
      depth += closes ? -1 : is_empty ? 0 : 1;
    }
    if (depth > kMaxXmlDepth) {
      throw InputError(fmt::format("{}: elements are nested deeper than {}", where, kMaxXmlDepth));
    }
  }
}

}  // namespace

UrdfPlace urdf_place(const std::string& urdf, const std::string& where) {
  return [urdf, where](const std::string& tag, const std::string& name) {
    for (const char* quote : {"\"", "'"}) {
      const std::size_t found = urdf.find("<" + tag + " name=" + quote + name + quote);
      if (found == std::string::npos) continue;
      const auto end = urdf.begin() + static_cast<std::ptrdiff_t>(found);
      return fmt::format("{}:{}", where, 1 + std::count(urdf.begin(), end, '\n'));
    }
    return where;
  };
}

std::shared_ptr<const urdf::ModelInterface> parse_urdf(const std::string& urdf,
                                                       const std::string& where) {
  if (urdf.size() > kMaxUrdfBytes) {
    throw InputError(fmt::format("{}: URDF is longer than {} bytes", where, kMaxUrdfBytes));
  }
  if (urdf.find_first_not_of(" \t\r\n") == std::string::npos) {
    throw InputError(where + ": the URDF is empty");
  }
  check_text(urdf, where);
  check_xml_depth(urdf, where);
  std::shared_ptr<const urdf::ModelInterface> model;
  std::string messages;
  try {
    const ParserMessages capture;
    model = urdf::parseURDF(urdf);
    messages = capture.text();
  } catch (const std::exception& error) {
    messages = error.what();
  }
  // urdfdom logs errors that it goes on from, such as a wrong collision shape, which would then be
  // missing without a word.
  if (model == nullptr || !messages.empty()) {
    const bool is_cycle = messages.find("No root link") != std::string::npos;
    throw InputError(fmt::format("{}: not valid URDF: {}{}", where,
                                 messages.empty() ? "it cannot be parsed" : messages,
                                 is_cycle ? " Every link is the child of a joint, so that joints "
                                            "form a cycle: make one link the child of none."
                                          : ""));
  }
  return model;
}

}  // namespace pliant
