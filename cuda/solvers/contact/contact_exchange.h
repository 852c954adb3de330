#pragma once

#include <string>
#include <vector>

#include "cuda/solvers/contact/contact_table.h"
#include "pliant/core/system/system.h"

namespace pliant {

/// Why a GPU cannot take these constraints; empty where it can: contact with obstacles and
/// friction.
std::string why_not_exchanged(const std::vector<Constraint*>& constraints);

/// The contacts that the system's constraints found, as they are at the `predicted` positions,
/// their particles by `place`.
void collect_contacts(const ProjectiveSystem& system, const Positions& predicted,
                      const std::vector<int>& place, ContactTable& table);

/// Hands the table's forces back to the constraints.
void return_forces(const ContactTable& table, ProjectiveSystem& system);

}  // namespace pliant
