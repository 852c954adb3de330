#pragma once

#include <string>

namespace pliant {

/// Where the script `name` of Pliant is: beside the program in a build folder of the source tree, in
/// the source tree that it was built from, or where it was installed to; empty when it is nowhere.
std::string find_script(const std::string& name);

/// Runs scripts/plot_accuracy on `folder`, which writes accuracy.png and accuracy.svg there. False,
/// with the reason on stderr, when there is no such script or matplotlib, or it failed.
bool plot_accuracy(const std::string& folder);
/// As plot_accuracy(), with scripts/plot_reduced and the tables of `pliant study reduced`.
bool plot_reduced(const std::string& folder);
/// Likewise, with scripts/plot_viscoelastic and the tables of `pliant study viscoelastic`.
bool plot_viscoelastic(const std::string& folder);
/// Likewise, with scripts/plot_cloth and the tables of `pliant study cloth`.
bool plot_cloth(const std::string& folder);

}  // namespace pliant
