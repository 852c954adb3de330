#include "pliant/core/checkpoint_file.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <cstring>
#include <type_traits>

#include "pliant/math/error.h"

namespace pliant {
namespace {

/// The number rises whenever what a state has, or what effects and solvers keep, changes.
constexpr std::string_view kKind = "Pliant state 6\n";

/// Appends to bytes. It and StateReader take the same calls, so that one list of what a state has
/// (transfer()) serves both.
class StateWriter {
 public:
  template <class Number, class = std::enable_if_t<std::is_arithmetic_v<Number>>>
  void operator()(const Number& number) {
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  void operator()(const std::string& text) {
    (*this)(text.size());
    bytes += text;
  }
  void operator()(const Eigen::Matrix3Xd& values) { numbers(values.data(), values.size()); }
  void operator()(const Eigen::VectorXd& values) { numbers(values.data(), values.size()); }
  void operator()(const std::vector<double>& values) {
    numbers(values.data(), static_cast<Eigen::Index>(values.size()));
  }
  void operator()(const Eigen::Isometry3d& pose) { numbers(pose.data(), 16); }
  void operator()(StateArchive archive) {
    archive.rewind();
    std::vector<double> values(archive.size());
    for (double& value : values) value = archive.read();
    (*this)(values);
  }
  void check(const Particles& /*particles*/) const {}
  template <class Item, class Use>
  void each(const std::vector<Item>& items, const Use& use) {
    (*this)(items.size());
    for (const Item& item : items) use(item);
  }

  std::string bytes;

 private:
  void numbers(const double* values, Eigen::Index count) {
    (*this)(static_cast<std::size_t>(count));
    bytes.append(reinterpret_cast<const char*>(values),
                 static_cast<std::size_t>(count) * sizeof(double));
  }
};

/// Reads what a StateWriter wrote; no size is believed that the bytes do not have.
class StateReader {
 public:
  StateReader(std::string_view bytes, const std::string& where) : bytes_(bytes), where_(where) {}

  template <class Number, class = std::enable_if_t<std::is_arithmetic_v<Number>>>
  void operator()(Number& number) {
    std::memcpy(&number, take(sizeof number), sizeof number);
  }
  void operator()(bool& flag) { flag = *take(1) != 0; }
  void operator()(std::string& text) {
    const std::size_t size = count(1);
    text.assign(take(size), size);
  }
  void operator()(Eigen::Matrix3Xd& values) {
    const std::vector<double> all = numbers();
    if (all.size() % 3 != 0) refuse();
    values = Eigen::Map<const Eigen::Matrix3Xd>(all.data(), 3,
                                                static_cast<Eigen::Index>(all.size() / 3));
  }
  void operator()(Eigen::VectorXd& values) {
    const std::vector<double> all = numbers();
    values = Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
  }
  void operator()(std::vector<double>& values) { values = numbers(); }
  void operator()(Eigen::Isometry3d& pose) {
    const std::vector<double> all = numbers();
    if (all.size() != 16) refuse();
    pose.matrix() = Eigen::Map<const Eigen::Matrix4d>(all.data());
  }
  void operator()(StateArchive& archive) {
    archive.clear();
    for (const double value : numbers()) archive.write(value);
  }
  template <class Item, class Use>
  void each(std::vector<Item>& items, const Use& use) {
    // One by one: what a damaged file counts ends where its bytes do.
    items.clear();
    for (std::size_t left = count(1); left > 0; --left) use(items.emplace_back());
  }
  /// All numbers of a particle are there, or of those that may be empty none, and it can be.
  void check(const Particles& p) const {
    const Eigen::Index n = p.x.cols();
    bool fits = p.v.cols() == n && p.mass.size() == n && p.inverse_mass.size() == n;
    for (const Eigen::Matrix3Xd* values :
         {&p.x_start, &p.v_start, &p.v_before, &p.inertia.x, &p.inertia.v, &p.history.moved,
          &p.history.gained, &p.history_before.moved, &p.history_before.gained}) {
      fits = fits && (values->cols() == n || values->cols() == 0);
    }
    fits = fits && (!p.inertia.is_used || p.inertia.x.cols() == n);
    // A step that fails is undone, so that no state that was saved has others.
    fits = fits && p.x.allFinite() && p.v.allFinite() && p.mass.allFinite() &&
           p.inverse_mass.allFinite() && (p.mass.array() >= 0.0).all() &&
           (p.inverse_mass.array() >= 0.0).all();
    if (!fits) refuse();
  }
  bool is_at_end() const { return bytes_.empty(); }

  [[noreturn]] void refuse() const {
    throw InputError(where_ +
                     ": it is no whole state: it is damaged, something else, or of another version "
                     "of Pliant");
  }

 private:
  const char* take(std::size_t size) {
    if (size > bytes_.size()) refuse();
    const char* begin = bytes_.data();
    bytes_.remove_prefix(size);
    return begin;
  }
  std::size_t count(std::size_t item_size) {
    std::size_t size = 0;
    (*this)(size);
    if (size > bytes_.size() / item_size) refuse();
    return size;
  }
  std::vector<double> numbers() {
    std::vector<double> values(count(sizeof(double)));
    const std::size_t size = values.size() * sizeof(double);
    if (size > 0) std::memcpy(values.data(), take(size), size);
    return values;
  }

  std::string_view bytes_;
  const std::string& where_;
};

template <class Stream, class History>
void transfer_history(Stream& stream, History& history) {
  stream(history.dt);
  stream(history.reserve);
  stream(history.touched);
  stream(history.moved);
  stream(history.gained);
}

template <class Stream, class AnyParticles>
void transfer_particles(Stream& stream, AnyParticles& p) {
  for (auto* values : {&p.x, &p.v, &p.x_start, &p.v_start, &p.v_before}) stream(*values);
  stream(p.inertia.is_used);
  stream(p.inertia.share);
  stream(p.inertia.step);
  stream(p.inertia.whole);
  stream(p.inertia.x);
  stream(p.inertia.v);
  transfer_history(stream, p.history);
  transfer_history(stream, p.history_before);
  stream(p.mass);
  stream(p.inverse_mass);
  stream.check(p);
}

/// What a file holds of a state, in its order.
template <class Stream, class State>
void transfer(Stream& stream, State& state) {
  auto& checkpoint = state.checkpoint;
  stream(checkpoint.time_step);
  stream(checkpoint.time);
  stream(checkpoint.steps);
  stream.each(checkpoint.bodies, [&](auto& body) {
    stream(body.name);
    transfer_particles(stream, body.particles);
    stream.each(body.effects, [&](auto& effect) { stream(effect); });
    stream(body.numbers);
    stream(body.solver);
    stream(body.learned);
    stream(body.solver_dt);
    stream(body.effective_dt);
  });
  stream.each(checkpoint.obstacles, [&](auto& obstacle) {
    stream(obstacle.start);
    stream(obstacle.end);
  });
  stream(checkpoint.driven);
  stream.each(state.joints, [&](auto& joints) { stream(joints); });
}

}  // namespace

std::string state_bytes(const SavedState& state) {
  if (!state.checkpoint.applied_forces.empty() || !state.checkpoint.field_ramps.empty()) {
    throw InputError(
        "a file holds no forces that act and no fields on their way to a value: end them first "
        "(clear_forces())");
  }
  StateWriter writer;
  transfer(writer, state);
  std::string bytes(kKind);
  const XXH64_hash_t hash = XXH3_64bits(writer.bytes.data(), writer.bytes.size());
  bytes.append(reinterpret_cast<const char*>(&hash), sizeof hash);
  return bytes + writer.bytes;
}

SavedState state_of(std::string_view bytes, const std::string& where) {
  XXH64_hash_t hash = 0;
  const std::size_t begin = kKind.size() + sizeof hash;
  if (bytes.size() < begin || bytes.substr(0, kKind.size()) != kKind) {
    StateReader({}, where).refuse();
  }
  std::memcpy(&hash, bytes.data() + kKind.size(), sizeof hash);
  bytes.remove_prefix(begin);
  StateReader reader(bytes, where);
  if (XXH3_64bits(bytes.data(), bytes.size()) != hash) reader.refuse();
  SavedState state;
  transfer(reader, state);
  if (!reader.is_at_end()) reader.refuse();
  return state;
}

}  // namespace pliant
