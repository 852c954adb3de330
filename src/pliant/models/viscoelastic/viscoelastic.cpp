#include "pliant/models/viscoelastic/viscoelastic.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/core/body.h"
#include "pliant/core/columns.h"
#include "pliant/core/group.h"
#include "pliant/core/step/particle_resident_run.h"
#include "pliant/math/error.h"
#include "pliant/math/joined.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {
namespace {

// Clusters follow beta no more often than this [s]: solvers have to be prepared for it.
constexpr double kFollowInterval = 0.02;
// Clusters reach so many particle spacings unless the scene says otherwise; not a whole number, so
// that round-off does not decide on a lattice.
constexpr double kClusterRadius = 2.1;
// Of the surface's kernel, in particle spacings.
constexpr double kSurfaceSupport = 2.0;
// Forces that add up to less than this share of them are pairs.
constexpr double kRoundOff = 1e-10;
// Beyond this, substeps are not counted: a power of 2.
constexpr int kMostSubsteps = 1 << 30;
// What melts darkens by this share.
constexpr float kMeltedDarker = 0.25f;

/// The least of 1, 2, 3, 4, 6, 8, 12, 16, 24 ... that is no less: so that the number changes
/// rarely. More than a step is ever allowed, and what is no number, is kMostSubsteps: an integer
/// would not hold it.
int rounded_substeps(double substeps) {
  if (!(substeps <= kMostSubsteps)) return kMostSubsteps;
  int power = 1;
  while (power < substeps) power *= 2;
  return power >= 4 && 0.75 * power >= substeps ? 3 * power / 4 : power;
}

/// The number before it there; 0 before 1.
int fewer_substeps(int substeps) {
  if (substeps <= 2) return substeps - 1;
  return (substeps & (substeps - 1)) == 0 ? 3 * substeps / 4 : 2 * substeps / 3;
}

/// Whether contact between the bodies of a group found anything in this step.
bool is_near_another(const Group& group) {
  if (group.joint() == nullptr) return false;
  const auto& between = group.joint()->between();
  return std::any_of(between.begin(), between.end(),
                     [](const Constraint* contact) { return !contact->is_idle(); });
}

}  // namespace

ViscoelasticModel::ViscoelasticModel(const BodyGeometry& geometry, const Material& material)
    : system_(material.oriented, material.turn_blend) {
  const Eigen::Index count = geometry.interior_points.cols();
  if (count == 0 || !(geometry.volume > 0.0)) {
    throw InputError("model 'viscoelastic' needs a body filled with particles");
  }
  const Eigen::VectorXd volumes =
      Eigen::VectorXd::Constant(count, geometry.volume / static_cast<double>(count));
  const Eigen::VectorXd masses = material.liquid.density * volumes;
  system_.particles = Particles(geometry.interior_points, masses);
  add_part(geometry.interior_points, masses, volumes, material);
  system_.solid().follow(system_.beta, system_.particles.x);
}

void ViscoelasticModel::add_part(const Positions& x, const Eigen::VectorXd& masses,
                                 const Eigen::VectorXd& volumes, const Material& material) {
  Part part{system_.liquid.size(), static_cast<int>(x.cols()), material, color, {}};
  SolidMaterial solid = material.solid;
  if (solid.cluster_radius == 0.0) {
    solid.cluster_radius = kClusterRadius * std::cbrt(volumes.maxCoeff());
  }
  system_.liquid.add_part(volumes, material.liquid);
  system_.solid().add_part(x, masses, volumes, solid);
  system_.beta = above(system_.beta, Eigen::VectorXd::Constant(part.count, material.beta));
  initial_beta_ = system_.beta;
  areas_ = above(areas_, volumes.array().pow(2.0 / 3.0));
  parts_.push_back(std::move(part));
}

bool ViscoelasticModel::join(Model& base) {
  auto* other = base.find<ViscoelasticModel>();
  if (other == nullptr) return false;
  const BlendedClusters &own = system_.solid(), &theirs_solid = other->system_.solid();
  if (theirs_solid.is_oriented() != own.is_oriented() || theirs_solid.blend() != own.blend()) {
    throw InputError(
        "bodies of model 'viscoelastic' in one scene touch each other, so that 'oriented' and "
        "'turn_blend' have to be the same for all of them");
  }
  for (Part& part : parts_) part.color = color_of(part);
  const Particles& theirs = other->particles();
  for (const Part& part : other->parts_) {
    add_part(theirs.x.middleCols(part.first, part.count),
             theirs.mass.segment(part.first, part.count),
             other->volumes().segment(part.first, part.count), part.material);
    parts_.back().color = other->color_of(part);
  }
  particles().append(theirs);
  system_.solid().follow(system_.beta, particles().x);
  return true;
}

void ViscoelasticModel::place(const Eigen::Isometry3d& world_from_body) {
  Model::place(world_from_body);
  system_.solid().place(world_from_body);
}

int ViscoelasticModel::substeps_of_step(double dt) const {
  if (!system_.liquid.acts(system_.beta)) return 1;
  const Positions& v = particles().v;
  const double squared = parallel_reduce(
      0, particles().size(), kColumnGrain,
      [&](int begin, int end) {
        return v.middleCols(begin, end - begin).colwise().squaredNorm().maxCoeff();
      },
      [](double a, double b) { return std::max(a, b); });
  return rounded_substeps(dt / system_.liquid.stable_step(std::sqrt(squared)));
}

std::string ViscoelasticModel::why_no_step(double dt, int substeps, std::uint64_t step) const {
  const ClusterSet* clusters = system_.solid().set();
  if (step == 1 && clusters != nullptr && !system_.solid().is_oriented()) {
    const int cluster = clusters->shapes().first_inside_out(particles().x);
    if (cluster >= 0) {
      return fmt::format(
          "cluster {} begins inside out, where shape matching would hold it, since no rotation "
          "leads back: begin with its rest shape, or give the material `oriented: true`",
          cluster);
    }
  }
  const int most = parts_.front().material.max_substeps;
  if (substeps <= most) return {};
  const bool is_counted = substeps < kMostSubsteps;
  return fmt::format(
      "the liquid needs {}{} substeps for a step of {:g} s, but at most {} are allowed "
      "(max_substeps): "
      "take a time step of {}{:.3g} s, a lower sound_speed or viscosity, or larger particles",
      is_counted ? "" : "more than ", substeps, dt, most, is_counted ? "" : "less than ",
      most * dt / substeps);
}

StepPlan ViscoelasticModel::plan_step(double dt, StepReport& report) {
  StepPlan plan;
  ScopedPhase phase(report, "clusters");
  plan.substeps = substeps_of_step(dt);
  plan.refusal = why_no_step(dt, plan.substeps, report.step);
  if (!plan.refusal.empty()) return plan;  // and nothing changed
  plan.system_changed = system_.solid().set_time_step(dt);
  const auto number = static_cast<double>(report.step);
  if (system_.counted_step != number) system_.unfollowed += dt;
  system_.counted_step = number;
  const bool is_due = system_.unfollowed >= kFollowInterval;
  // At the start too: what heat finds frozen is a solid from the first step on, not loose
  // particles.
  if (is_due || report.step == 1) {
    plan.system_changed |= system_.solid().follow(system_.beta, particles().x);
  }
  if (is_due) system_.unfollowed = 0.0;
  return plan;
}

int ViscoelasticModel::steps_unfollowed(double dt, int most) const {
  int steps = 0;
  for (double time = system_.unfollowed + dt; steps < most && time < kFollowInterval; time += dt) {
    ++steps;
  }
  return steps;
}

bool ViscoelasticModel::join_resident_run(ResidentRun& run) const {
  const double dt = run.step_time;
  const Liquid& liquid = system_.liquid;
  run.substeps = substeps_of_step(dt);
  if (system_.solid().is_oriented() || run.substeps > parts_.front().material.max_substeps) {
    return false;
  }
  run.dt = dt / run.substeps;
  if (!system_.solid().follows(system_.beta)) {
    run.steps = steps_unfollowed(dt, run.steps);
  }
  auto own = std::make_shared<ParticleResidentRun>();
  own->flows = liquid.acts(system_.beta);
  own->melts = system_.beta.maxCoeff() > 0.0;
  own->most_speed = std::numeric_limits<double>::infinity();
  if (own->flows) {
    own->most_speed = liquid.stable_speed(run.dt);
    const int fewer = fewer_substeps(run.substeps);
    // Viscosity may forbid fewer substeps at any speed.
    const bool may_be_fewer = fewer > 0 && dt / liquid.viscous_step() <= fewer;
    own->least_speed = may_be_fewer ? liquid.stable_speed(dt / fewer) : -1.0;
  }
  run.particles = std::move(own);
  return true;
}

void ViscoelasticModel::after_resident_run(const ResidentRun& run, int steps) {
  for (int k = 0; k < steps; ++k) {
    // Weights were those of beta already, or the run ended before this.
    system_.unfollowed += run.step_time;
    if (system_.unfollowed >= kFollowInterval) system_.unfollowed = 0.0;
  }
  pushes_walls_ = false;  // their forces in the last substep are the solver's to tell
}

void ViscoelasticModel::follow_backend(const Solver& solver, StepReport& report) {
  if (solver.runs_on_gpu() == is_on_gpu_) return;
  is_on_gpu_ = !is_on_gpu_;
  system_.liquid.set_device(nullptr);
  for (Part& part : parts_) part.surface.set_device(nullptr);
  if (!is_on_gpu_) return;
  try {
    system_.liquid.set_device(make_cuda_liquid());
    for (Part& part : parts_) part.surface.set_device(make_cuda_surface());
  } catch (const DeviceFailure& failure) {
    report.warn(std::string("liquid_cpu: not on the GPU, but on the CPU: ") + failure.what());
  }
}

void ViscoelasticModel::tell_of_surfaces(StepReport& report) {
  for (Part& part : parts_) {
    const std::string reason = part.surface.take_device_failure();
    if (reason.empty()) continue;
    report.warn("surface_cpu: not on the GPU, but on the CPU: " + reason);
  }
}

void ViscoelasticModel::before_solver(Body& body, const std::vector<Obstacle>& obstacles,
                                      double dt) {
  pushes_walls_ = false;
  follow_backend(*body.solver, body.report);
  tell_of_surfaces(body.report);
  if (!system_.liquid.acts(system_.beta)) return;
  pushes_walls_ = !obstacles.empty() && body.find_effect("contact") != nullptr;
  if (pushes_walls_) {
    ScopedPhase phase(body.report, "walls");
    system_.walls.find(particles().x, obstacles, support(), dt);
  }
  system_.liquid.add_forces(particles(), system_.beta, pushes_walls_ ? &system_.walls : nullptr,
                            system_.external_forces, body.report);
  // Single particles are, where drops hit each other.
  constexpr double kMostCompressed = 0.1;
  if (system_.liquid.compressed_share(system_.beta) > kMostCompressed) {
    body.report.warn(
        "liquid_compressed: a tenth of the liquid has four fifths of its volume or less, and flies "
        "apart where it gets free: give the material a larger sound_speed, at least ten times the "
        "fastest motion");
  }
}

bool ViscoelasticModel::needs_first_order() const { return system_.liquid.acts(system_.beta); }

bool ViscoelasticModel::constraints_are_inner() {
  parallel_zero(particles().size(), inner_);
  for (const Constraint* constraint : system_.constraints) {
    if (constraint->active() == 0) continue;
    constraint_forces_.setZero(3, particles().size());
    constraint->add_forces(constraint_forces_);
    const double all = constraint_forces_.cwiseAbs().sum();
    if (!(constraint_forces_.rowwise().sum().cwiseAbs().sum() <= kRoundOff * all)) return false;
    inner_ += constraint_forces_;
  }
  if (system_.forces_of_bodies.cols() > 0) inner_ += system_.forces_of_bodies;
  return true;
}

void ViscoelasticModel::keep_momentum(double dt) {
  for (const auto& set : system_.elements) {
    // Attachments pull from outside.
    if (set.get() != &system_.solid() && set->size() > 0) return;
  }
  if (!constraints_are_inner()) return;
  for (const Part& part : parts_) keep_momentum(part, dt);
}

void ViscoelasticModel::keep_momentum(const Part& part, double dt) {
  // What holds a part together adds up to nothing.
  struct Sums {
    Eigen::Vector3d missing = Eigen::Vector3d::Zero();
    double mass = 0.0;
    bool is_free = true;
  };
  Particles& p = particles();
  const Eigen::Matrix3Xd& velocity = p.v_inertial();
  if (p.inertia.is_used) dt = p.inertia.step;
  const int end_of_part = part.first + part.count;
  const Sums all = parallel_reduce(
      part.first, end_of_part, kColumnGrain,
      [&](int begin, int end) {
        Sums sums;
        for (int i = begin; i < end; ++i) {
          sums.is_free &= !p.is_fixed(i);
          sums.missing += p.mass[i] * (velocity.col(i) - p.v.col(i)) +
                          dt * (system_.external_forces.col(i) + inner_.col(i));
          sums.mass += p.mass[i];
        }
        return sums;
      },
      [](const Sums& one, const Sums& other) {
        return Sums{one.missing + other.missing, one.mass + other.mass,
                    one.is_free && other.is_free};
      });
  if (!all.is_free) return;
  const Eigen::Vector3d change = all.missing / all.mass;
  parallel_for(part.first, end_of_part, kColumnGrain, [&](int begin, int end) {
    p.v.middleCols(begin, end - begin).colwise() += change;
    p.x.middleCols(begin, end - begin).colwise() += dt * change;
  });
}

void ViscoelasticModel::after_solver(Body& body, double dt) {
  // Iterations that end early leave a little of the forces between particles unbalanced. Beside
  // another body, what a correction moved might pass into it.
  if (system_.solid().clusters() > 0 && !is_near_another(*body.group)) keep_momentum(dt);
  system_.solid().advance(particles().x, dt);
  if (system_.keeps_losses() && system_.liquid.acts(system_.beta)) note_viscous_losses(dt);
}

void ViscoelasticModel::note_viscous_losses(double dt) {
  Eigen::VectorXd losses = system_.liquid.viscous_losses(particles(), system_.beta, dt);
  if (pushes_walls_) {
    system_.walls.add_losses(system_.liquid, particles(), system_.beta, dt, losses);
  }
  system_.note_motion_losses(losses);
}

void ViscoelasticModel::add_reactions(std::vector<Reaction>& reactions) const {
  if (pushes_walls_) system_.walls.add_reactions(reactions);
}

std::vector<LiquidWalls::Push> ViscoelasticModel::wall_pushes() const {
  if (!pushes_walls_) return {};
  return system_.walls.pushes();
}

std::vector<BlendedParticles::Part> ViscoelasticModel::blended_parts() const {
  std::vector<BlendedParticles::Part> parts;
  for (const Part& part : parts_) parts.push_back({part.first, part.count, part.material.heat});
  return parts;
}

void ViscoelasticModel::show_field(const std::string& name, const Eigen::VectorXd* values) {
  shown_.emplace_back(name, values);
}

std::map<std::string, Eigen::VectorXd> ViscoelasticModel::point_fields() const {
  Eigen::VectorXd density = system_.liquid.filling(particles().x);
  for (int i = 0; i < density.size(); ++i) density[i] *= system_.liquid.material(i).density;
  std::map<std::string, Eigen::VectorXd> fields = {{"beta", system_.beta},
                                                   {"density", std::move(density)},
                                                   {"clusters", system_.solid().counts()}};
  for (const auto& [name, values] : shown_) fields.emplace(name, *values);
  return fields;
}

std::vector<SettableField> ViscoelasticModel::settable_fields() {
  return {{number_parameter("beta", "", "", 0.0, 1.0, "0 solid to 1 liquid"),
           {},
           [this](int i) { return system_.beta[i]; },
           [this](int i, double beta) { set_beta(i, beta); }}};
}

Eigen::Vector3f ViscoelasticModel::color_of(const Part& part) const {
  return parts_.size() == 1 ? color : part.color;
}

Eigen::Matrix3Xf ViscoelasticModel::particle_colors() const {
  Eigen::Matrix3Xf colors(3, particles().size());
  for (const Part& part : parts_) {
    for (int i = part.first; i < part.first + part.count; ++i) {
      const auto melted = static_cast<float>(std::max(0.0, system_.beta[i] - initial_beta_[i]));
      colors.col(i) = (1.0f - kMeltedDarker * melted) * color_of(part);
    }
  }
  return colors;
}

Eigen::Matrix3Xf ViscoelasticModel::surface_colors() const {
  const Eigen::MatrixXd colors = particle_colors().cast<double>();
  Eigen::Matrix3Xf result(3, surface_vertices());
  Eigen::Index first = 0;
  for (const Part& part : parts_) {
    const auto own = colors.middleCols(part.first, part.count);
    const Eigen::Index count = part.surface.mesh().vertices.cols();
    auto drawn = result.middleCols(first, count);
    if (own.cols() > 0 && (own.colwise() - own.col(0)).isZero(0.0)) {
      drawn.colwise() = own.col(0).cast<float>();
    } else {
      drawn = part.surface.interpolate_rows(own).cast<float>();
    }
    first += count;
  }
  return result;
}

void ViscoelasticModel::refresh_surface() const {
  bool changed = triangles_.cols() == 0;
  for (const Part& part : parts_) {
    const auto x = particles().x.middleCols(part.first, part.count);
    if (part.surface.positions().cols() == x.cols() && part.surface.positions() == x) continue;
    const Eigen::VectorXd own = volumes().segment(part.first, part.count);
    part.surface.update(x, own,
                        {kSurfaceSupport * std::cbrt(own.mean()), part.material.surface_detail,
                         part.material.anisotropic_surface});
    changed = true;
  }
  if (!changed) return;
  Eigen::Index count = 0;
  for (const Part& part : parts_) count += part.surface.mesh().triangles.cols();
  triangles_.resize(3, count);
  Eigen::Index first = 0;
  int vertices = 0;
  for (const Part& part : parts_) {
    const TriangleMesh& mesh = part.surface.mesh();
    triangles_.middleCols(first, mesh.triangles.cols()) = mesh.triangles.array() + vertices;
    first += mesh.triangles.cols();
    vertices += static_cast<int>(mesh.vertices.cols());
  }
}

const Eigen::Matrix3Xi& ViscoelasticModel::surface_triangles() const {
  refresh_surface();
  return triangles_;
}

int ViscoelasticModel::surface_vertices() const {
  refresh_surface();
  int count = 0;
  for (const Part& part : parts_) count += static_cast<int>(part.surface.mesh().vertices.cols());
  return count;
}

void ViscoelasticModel::surface_positions(Eigen::Ref<Eigen::Matrix3Xd> positions) const {
  refresh_surface();
  Eigen::Index first = 0;
  for (const Part& part : parts_) {
    const Eigen::Matrix3Xd& own = part.surface.mesh().vertices;
    positions.middleCols(first, own.cols()) = own;
    first += own.cols();
  }
}

Eigen::VectorXd ViscoelasticModel::on_surface(const Eigen::VectorXd& field) const {
  refresh_surface();
  Eigen::VectorXd values(surface_vertices());
  Eigen::Index first = 0;
  for (const Part& part : parts_) {
    const Eigen::VectorXd own = part.surface.interpolate(field.segment(part.first, part.count));
    values.segment(first, own.size()) = own;
    first += own.size();
  }
  return values;
}

}  // namespace pliant
