#pragma once

#include <pliant/Contacts.h>

#include <string>
#include <vector>

#include "pliant/ros/body_names.h"
#include "pliant/scene/contact_list.h"

namespace pliant {

/// What touches as a message, in the words of the scene.
class ContactMessages {
 public:
  ContactMessages(const World& world, const BodyNames& names);
  /// All of the message but its header.
  const Contacts& update(const std::vector<TouchedPoint>& touched, std::uint64_t step);
  Contacts& message() { return message_; }

 private:
  struct Other {
    std::string name;
    std::uint8_t kind;
  };
  std::vector<Other> obstacles_;
  std::vector<std::string> bodies_;
  Contacts message_;
};

}  // namespace pliant
