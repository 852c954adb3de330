#pragma once

#include <string>

namespace pliant {

/// A file of Pliant's sources or of what was installed, as "config/meshes/figure.obj": beside the
/// program in a build folder, in the source tree that it was built from, or where it was installed
/// to; empty when it is nowhere.
std::string find_shared(const std::string& file);
/// Runs scripts/plot_accuracy on `folder`, which writes accuracy.png and accuracy.svg there. False,
/// with the reason on stderr, when there is no such script or matplotlib, or it failed.
bool plot_accuracy(const std::string& folder);
/// As plot_accuracy(), with scripts/plot_reduced and the tables of `pliant study reduced`.
bool plot_reduced(const std::string& folder);
/// Likewise, with scripts/plot_viscoelastic and the tables of `pliant study viscoelastic`.
bool plot_viscoelastic(const std::string& folder);
/// Likewise, with scripts/plot_cloth and the tables of `pliant study cloth`.
bool plot_cloth(const std::string& folder);
/// Likewise, with scripts/plot_judges and the curves of `pliant study judge`.
bool plot_judges(const std::string& folder);

}  // namespace pliant
