#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/study/judges/judge.h"
#include "pliant/study/judges/liquid_tank.h"

namespace pliant {
namespace liquid_judges {
namespace {

constexpr double kGravity = 9.81;  // [m/s²]
constexpr double kWater = 1e-3;    // [Pa s]

/// A quantity over time, and what it is in between.
struct Curve {
  std::vector<double> times, values;

  void add(double time, double value) {
    times.push_back(time);
    values.push_back(value);
  }
  double at(double time) const {
    const auto after = std::lower_bound(times.begin(), times.end(), time) - times.begin();
    if (after == 0 || after == static_cast<std::ptrdiff_t>(times.size())) return std::nan("");
    const auto k = static_cast<std::size_t>(after);
    const double share = (time - times[k - 1]) / (times[k] - times[k - 1]);
    return values[k - 1] + share * (values[k] - values[k - 1]);
  }
  double mean(double begin, double end) const {
    double sum = 0.0;
    int count = 0;
    for (std::size_t k = 0; k < times.size(); ++k) {
      if (times[k] < begin || times[k] > end) continue;
      sum += values[k];
      ++count;
    }
    return sum / count;
  }
  /// When it first reaches a value.
  double reached(double value) const {
    for (std::size_t k = 1; k < times.size(); ++k) {
      if (values[k] < value) continue;
      const double share = (value - values[k - 1]) / (values[k] - values[k - 1]);
      return times[k - 1] + share * (times[k] - times[k - 1]);
    }
    return std::nan("");
  }
};

std::string rows_of(const Curve& curve, const std::string& name) {
  std::string rows;
  for (std::size_t k = 0; k < curve.times.size(); ++k) {
    rows += fmt::format("{},{:.5g},{:.5g}\n", name, curve.times[k], curve.values[k]);
  }
  return rows;
}

// ---- Martin and Moyce: a column of a width a = 2.25 inches, twice as high ----------------------

constexpr double kWidth = 0.05715;  // [m]

struct Point {
  double time, value;
};

/// Table 2: the front's place over a at times t √(2g/a).
constexpr Point kFront[] = {{0.41, 1.11}, {0.84, 1.22}, {1.19, 1.44}, {1.43, 1.67}, {1.63, 1.89},
                            {1.83, 2.11}, {1.98, 2.33}, {2.20, 2.56}, {2.32, 2.78}, {2.51, 3.00},
                            {2.65, 3.22}, {2.83, 3.44}, {2.98, 3.67}, {3.11, 3.89}, {3.33, 4.11}};
/// Table 6: the height at the wall over 2 a at times t √(g/a).
constexpr Point kTop[] = {{0.56, 0.94}, {0.77, 0.89}, {0.93, 0.83}, {1.08, 0.78}, {1.28, 0.72},
                          {1.46, 0.67}, {1.66, 0.61}, {1.84, 0.56}, {2.00, 0.50}, {2.21, 0.44}};

struct Collapse {
  Curve front, top;
};

/// With so many particles across the width.
Collapse collapse(int across, const JudgeOptions& options, double begun, double share) {
  const double spacing = kWidth / across, unit = std::sqrt(kWidth / kGravity);
  LiquidTank tank({{across, 8, 2 * across},
                   spacing,
                   10.0 * std::sqrt(kGravity * 2.0 * kWidth),
                   kWater,
                   5e-4,
                   10.0 * kWidth,
                   false,
                   true});
  tank.release();
  Collapse found;
  const double end = 3.4 / std::sqrt(2.0) * unit;
  while (tank.time() < end && options.go_on(begun + share * tank.time() / end)) {
    tank.step();
    found.front.add(tank.time() * std::sqrt(2.0) / unit, tank.front() / kWidth);
    found.top.add(tank.time() / unit, tank.height_at_wall(0.1 * kWidth) / (2.0 * kWidth));
  }
  return found;
}

std::vector<JudgedFigure> judge_front(const JudgeOptions& options) {
  const Collapse coarse = collapse(10, options, 0.0, 0.1), fine = collapse(20, options, 0.1, 0.9);
  if (!options.folder.empty() && options.go_on(1.0)) {
    std::string rows =
        "curve,time,value\n" + rows_of(fine.front, "front") + rows_of(fine.top, "top");
    for (const Point& point : kFront) {
      rows += fmt::format("measured_front,{},{}\n", point.time, point.value);
    }
    for (const Point& point : kTop) {
      rows += fmt::format("measured_top,{},{}\n", point.time, point.value);
    }
    write_file_atomically(options.folder + "/dam_break_front.csv", rows);
  }
  std::vector<JudgedFigure> figures;
  for (const int k : {2, 6, 10, 14}) {
    figures.push_back({fmt::format("front at t sqrt(2g/a) = {}", kFront[k].time), "a",
                       kFront[k].value, fine.front.at(kFront[k].time),
                       coarse.front.at(kFront[k].time)});
  }
  // Whenever it was let go.
  const auto speed = [](const Curve& front) {
    return 2.0 / (front.reached(4.0) - front.reached(2.0));
  };
  Curve measured;
  for (const Point& point : kFront) measured.add(point.time, point.value);
  figures.push_back({"speed of the front from 2 a to 4 a", "sqrt(2ga)", speed(measured),
                     speed(fine.front), speed(coarse.front)});
  for (const int k : {2, 6}) {
    figures.push_back({fmt::format("height at t sqrt(g/a) = {}", kTop[k].time), "2a", kTop[k].value,
                       fine.top.at(kTop[k].time), coarse.top.at(kTop[k].time)});
  }
  return figures;
}

// ---- Buchner: a column of 1.2 m by 0.6 m in a tank of 3.22 m ------------------------------------

constexpr double kHeight = 0.6, kTank = 3.22, kSensor = 0.16, kDiameter = 0.09;  // [m]

/// Pressures on the far wall over ρ g H at times t √(g/H): on the sensor, and half a diameter
/// below.
struct Impact {
  Curve sensor, below;
};

Impact impact(double spacing, const JudgeOptions& options, double begun, double share) {
  const int high = static_cast<int>(std::lround(kHeight / spacing));
  LiquidTank tank({{2 * high, 4, high},
                   spacing,
                   10.0 * std::sqrt(kGravity * kHeight),
                   kWater,
                   5e-4,
                   kTank,
                   true,
                   true});
  tank.release();
  const double unit = std::sqrt(kHeight / kGravity), end = 4.7 * unit;
  const auto sensed = [&](double middle) {
    return tank.pressure_on_end(middle - 0.5 * kDiameter, middle + 0.5 * kDiameter) /
           (1000.0 * kGravity * kHeight);
  };
  Impact found;
  while (tank.time() < end && options.go_on(begun + share * tank.time() / end)) {
    tank.step();
    found.sensor.add(tank.time() / unit, sensed(kSensor));
    found.below.add(tank.time() / unit, sensed(kSensor - 0.5 * kDiameter));
  }
  return found;
}

std::vector<JudgedFigure> judge_pressure(const JudgeOptions& options) {
  const Impact coarse = impact(0.04, options, 0.0, 0.1), fine = impact(0.02, options, 0.1, 0.9);
  if (!options.folder.empty() && options.go_on(1.0)) {
    write_file_atomically(
        options.folder + "/dam_break_pressure.csv",
        "curve,time,value\n" + rows_of(fine.sensor, "pressure") + rows_of(fine.below, "below"));
  }
  std::vector<JudgedFigure> figures;
  // A tenth of ρ g H is passed between the measured (2.4726, 0.0767) and (2.4915, 0.1535).
  figures.push_back({"time at which the pressure rises", "sqrt(H/g)", 2.478,
                     fine.sensor.reached(0.1), coarse.sensor.reached(0.1)});
  const auto add = [&](double begin, double end, double measured) {
    const std::string name = fmt::format("mean pressure from {:.1f} to {:.1f}", begin, end);
    figures.push_back(
        {name, "rho g H", measured, fine.sensor.mean(begin, end), coarse.sensor.mean(begin, end)});
    figures.push_back({name + ", 45 mm lower", "rho g H", measured, fine.below.mean(begin, end),
                       coarse.below.mean(begin, end)});
  };
  add(2.7, 3.0, 0.666);
  add(3.4, 4.6, 0.548);
  return figures;
}

// ---- At rest ------------------------------------------------------------------------------------

/// Slope of the line through the particles' pressures over depth, without those at the surface.
double pressure_slope(LiquidTank& tank, double support) {
  const double surface = tank.particles().x.row(2).maxCoeff();
  double n = 0.0, z = 0.0, p = 0.0, zz = 0.0, zp = 0.0;
  for (int i = 0; i < tank.particles().size(); ++i) {
    const double depth = surface - tank.particles().x(2, i);
    if (depth < support) continue;
    n += 1.0;
    z += depth;
    p += tank.pressure(i);
    zz += depth * depth;
    zp += depth * tank.pressure(i);
  }
  return (n * zp - z * p) / (n * zz - z * z);
}

std::vector<JudgedFigure> judge_rest(const JudgeOptions& options) {
  constexpr double kSpacing = 0.01;
  const Eigen::Vector3i counts(8, 8, 16);
  const double height = kSpacing * counts.z();
  // The density then grows by half a percent down to the floor.
  LiquidTank tank({counts, kSpacing, std::sqrt(kGravity * height / 0.005), 0.5, 0.01,
                   kSpacing * counts.x(), true, false});
  while (tank.time() < 1.5 && options.go_on(tank.time() / 1.5)) tank.step();
  double floor = 0.0;
  constexpr int kSteps = 20;
  for (int k = 0; k < kSteps; ++k) {
    tank.step();
    floor -= tank.world().reactions()[0].force.z() / kSteps;
  }
  return {{"pressure's growth with depth", "Pa/m", 1000.0 * kGravity,
           pressure_slope(tank, 2.0 * kSpacing)},
          {"force on the floor", "N", kGravity * tank.particles().mass.sum(), floor}};
}

}  // namespace
}  // namespace liquid_judges

Judge liquid_at_rest_judge() {
  return {"liquid_at_rest",
          "hydrostatics, closed form: dp/dz = rho g",
          "8 x 8 x 16 particles in a basin, 1 cm apart, after 1.5 s",
          kComputed,
          false,
          liquid_judges::judge_rest};
}

Judge dam_break_front_judge() {
  return {"dam_break_front",
          "Martin and Moyce 1952 (Phil. Trans. R. Soc. A 244), tables 2 and 6, n2 = 2, a = 2.25 in",
          "column of water, 57 mm wide and twice as high, let go at once, 20 x 8 x 40 particles",
          kMeasured,
          false,
          liquid_judges::judge_front,
          true};
}

Judge dam_break_pressure_judge() {
  return {
      "dam_break_pressure",
      "Buchner 2002 (thesis, TU Delft; the experiment of Zhou, De Kat and Buchner 1999), sensor "
      "P1 as digitised by the authors of TrixiParticles.jl; Adami, Hu and Adams 2012 compare half "
      "a "
      "sensor lower",
      "column of water of 1.2 x 0.6 m in a tank of 3.22 m, sensor of 90 mm at a height of 160 "
      "mm, particles 2 cm apart, four across",
      kMeasured,
      false,
      liquid_judges::judge_pressure,
      true};
}

}  // namespace pliant
