#pragma once

#include <optional>

#include "pliant/models/reduced/quartic_potential.h"
#include "pliant/models/reduced/reduced_basis.h"

namespace pliant {

/// V(q) = W(U q) of a St. Venant-Kirchhoff body, exactly, from one pass over its tetrahedra. In
/// each the strain is a quadratic polynomial of q,
///   E = Σ qᵢ sym(Gᵢ) + ½ Σ qᵢ qⱼ sym(Gᵢᵀ Gⱼ)  with Gᵢ = ∇uᵢ of column i,
/// and W a quadratic form of E. Nothing when `progress` asks to stop. Throws InputError for a rank
/// above kMaxRank.
std::optional<QuarticPotential> project_potential(const StvkBody& body, const ReducedBasis& basis,
                                                  const ReduceProgress& progress);

}  // namespace pliant
