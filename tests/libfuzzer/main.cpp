// One target of tests/fuzz for libFuzzer: the environment variable PLIANT_FUZZ_TARGET names it.
// With PLIANT_FUZZ_SEEDS, a folder, its seeds are written there and nothing else is done; without
// either, the names of all are printed. scripts/fuzz does the rest.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "fuzz/targets.h"

namespace {

const pliant::FuzzTarget* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* name = std::getenv("PLIANT_FUZZ_TARGET");
  for (const pliant::FuzzTarget& target : pliant::fuzz_targets()) {
    if (name == nullptr) std::puts(target.name.c_str());
    if (name != nullptr && target.name == name) chosen = &target;
  }
  if (chosen == nullptr) std::exit(name == nullptr ? 0 : 2);
  if (const char* folder = std::getenv("PLIANT_FUZZ_SEEDS")) {
    for (std::size_t k = 0; k < chosen->seeds.size(); ++k) {
      std::ofstream(std::string(folder) + "/seed_" + std::to_string(k), std::ios::binary)
          << chosen->seeds[k];
    }
    std::exit(0);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  chosen->read(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
