#include <iostream>
#include <memory>

#include "pliant/app/commands.h"
#include "pliant/app/scene_options.h"

namespace pliant {

void add_check_command(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "check", "Check a scene and every file that it names; print OK or what is wrong");
  auto options = std::make_shared<SceneOptions>();
  add_scene_options(*command, *options);
  command->callback([options, &exit_code] {
    load_scene(*options);
    std::cout << options->path << ": OK" << std::endl;
    exit_code = kOk;
  });
}

}  // namespace pliant
