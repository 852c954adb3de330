// Lifts a napkin and a lump of jelly on a tray, and weighs them by the force on the tray.
#include <pliant/simulator.h>

#include <algorithm>
#include <cstdio>

int main(int argc, char** argv) {
  try {
    pliant::SimulatorOptions options;
    options.values["bodies[jelly].material.density"] = "800";
    pliant::Simulator simulator(argc > 1 ? argv[1] : "tray.yaml", options);
    for (const std::string& warning : simulator.warnings()) std::puts(warning.c_str());

    while (simulator.time() < 2.0) {  // [s]
      const double height = std::min(0.1, 0.1 * simulator.time());
      simulator.set_joint_positions({{"height", height}});  // [m]
      simulator.step();
    }
    for (const std::string& body : simulator.bodies()) {
      const double height = simulator.vertices(body).row(2).mean();
      std::printf("%s: mean height %.3f m\n", body.c_str(), height);
    }
    for (const pliant::Simulator::Wrench& wrench : simulator.wrenches()) {
      std::printf("%s: pressed down by %.3f N\n", wrench.name.c_str(), -wrench.force.z());
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
