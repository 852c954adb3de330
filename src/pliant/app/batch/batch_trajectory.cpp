#include "pliant/app/batch/batch_trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "pliant/math/error.h"
#include "pliant/scene/contact_list.h"
#include "pliant/scene/yaml/table_cell.h"

namespace pliant {
namespace {

const std::vector<std::string>& field_names() {
  static const std::vector<std::string> names = {"positions", "velocities", "points", "wrenches",
                                                 kContacts};
  return names;
}

std::uint64_t parse_every(const std::string& text) {
  std::uint64_t every = 0;
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, every);
  if (error != std::errc() || last != end || every == 0) {
    throw InputError("--trajectory every:" + text + ": every must be a whole number >= 1 of steps");
  }
  return every;
}

std::vector<std::string> parse_fields(const std::string& text) {
  std::vector<std::string> fields;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    fields.push_back(text.substr(begin, end - begin));
    const auto& known = field_names();
    if (std::find(known.begin(), known.end(), fields.back()) == known.end()) {
      throw InputError("--trajectory: " + unknown_name_message("field", fields.back(), known));
    }
    begin = end + 1;
  }
  return fields;
}

}  // namespace

TrajectoryOptions parse_trajectory(const std::vector<std::string>& texts) {
  TrajectoryOptions options;
  for (const std::string& text : texts) {
    const std::size_t colon = std::min(text.find(':'), text.size());
    const std::string key = text.substr(0, colon);
    const std::string value = text.substr(std::min(colon + 1, text.size()));
    if (key == "every") {
      options.every = parse_every(value);
    } else if (key == "fields") {
      options.fields = parse_fields(value);
    } else {
      throw InputError("--trajectory " + text + ": write every:N fields:positions,wrenches");
    }
  }
  if (texts.empty()) return options;
  if (options.every == 0) throw InputError("--trajectory: 'every:N' is missing");
  if (options.fields.empty()) options.fields = {"positions"};
  return options;
}

BatchTrajectory::BatchTrajectory(const TrajectoryOptions& options, const BatchRows& rows,
                                 const World& first, std::uint64_t steps, const std::string& folder,
                                 std::size_t kept, bool are_there)
    : every_(options.every), rows_(rows) {
  if (every_ == 0) return;
  const std::size_t frames = steps / every_ + 1;
  const auto add_file = [&](Field field, const std::string& body, std::size_t count,
                            std::size_t width) {
    const std::string name = "/trajectory_" + (body.empty() ? "" : body + "_") +
                             field_names()[static_cast<std::size_t>(field)] + ".npy";
    files_.push_back({field, body, count * width,
                      GrowingNpy(folder + name, {frames, count, width}, kept, are_there)});
  };
  for (std::size_t f = 0; f < field_names().size(); ++f) {
    if (!options.has(field_names()[f])) continue;
    if (field_names()[f] == kContacts) {
      has_contacts_ = true;
      continue;
    }
    const auto field = static_cast<Field>(f);
    if (field == Field::kWrenches) {
      add_file(field, "", rows.wrench_names().size(), 6);
      continue;
    }
    for (const Body& body : first.bodies()) {
      if (field == Field::kPoints && body.model->surface_changes()) {
        throw InputError(fmt::format(
            "--trajectory: the surface of body '{}' has other points in each step: record its "
            "'positions'",
            body.name));
      }
      const int count =
          field == Field::kPoints ? body.model->surface_vertices() : body.particles().size();
      add_file(field, body.name, static_cast<std::size_t>(count), 3);
    }
  }
}

std::vector<double> BatchTrajectory::numbers_of(const File& file, const World& world) const {
  if (file.field == Field::kWrenches) {
    std::vector<double> numbers;
    for (const Wrench& wrench : rows_.wrenches_of(world)) {
      numbers.insert(numbers.end(), wrench.force.data(), wrench.force.data() + 3);
      numbers.insert(numbers.end(), wrench.torque.data(), wrench.torque.data() + 3);
    }
    return numbers;
  }
  for (const Body& body : world.bodies()) {
    if (body.name != file.body) continue;
    Eigen::Matrix3Xd all;
    if (file.field == Field::kPoints) {
      all = body.model->surface().vertices;
    } else {
      all = file.field == Field::kPositions ? body.particles().x : body.particles().v;
    }
    return {all.data(), all.data() + all.size()};
  }
  return {};
}

void BatchTrajectory::add(std::size_t item, std::uint64_t step, const World& world,
                          bool has_stopped) const {
  const std::size_t frame = step / every_;
  for (const File& file : files_) {
    std::vector<double> numbers = numbers_of(file, world);
    if (has_stopped || numbers.size() != file.numbers) {
      numbers.assign(file.numbers, std::numeric_limits<double>::quiet_NaN());
    }
    file.npy.write(item, frame * file.numbers, numbers.data(), numbers.size());
  }
}

std::string BatchTrajectory::contact_rows(std::size_t scene, std::uint64_t step,
                                          const World& world) const {
  std::vector<TouchedPoint> touched;
  list_contacts(world, touched);
  std::string text;
  for (const TouchedPoint& t : touched) {
    const auto body = static_cast<std::size_t>(t.body);
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", scene, step / every_,
                        world.time(), table_cell(world.bodies()[body].name), t.vertex,
                        table_cell(name_of_other(t, world)), t.point[0], t.point[1], t.point[2],
                        t.normal[0], t.normal[1], t.normal[2], t.force[0], t.force[1], t.force[2]);
  }
  return text;
}

void BatchTrajectory::leave_out(std::size_t item) const {
  for (const File& file : files_) file.npy.leave_out(item);
}

void BatchTrajectory::publish(std::size_t items) const {
  for (const File& file : files_) file.npy.publish(items);
}

}  // namespace pliant
