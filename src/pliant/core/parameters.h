#pragma once

#include <Eigen/Core>
#include <limits>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace pliant {

enum class ParameterType { kNumber, kInteger, kFlag, kText, kVector };

/// One parameter of a solver, an effect or a model. The scene reader, `pliant list`, the services
/// and the documentation's tables all read this, so nothing is described twice.
struct ParameterSpec {
  std::string name;
  ParameterType type = ParameterType::kNumber;
  std::string unit;           ///< "" when there is none
  std::string default_value;  ///< as a user would write it; "" makes the parameter required
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_is_allowed = true;        ///< false makes the lower bound an open one
  std::vector<std::string> choices;  ///< for kText; empty allows any text
  std::string meaning;
  std::string former_name;  ///< that older scenes may use: refused by the present one; "": none

  /// "0 < value <= 10 [m]" or "one of a, b".
  std::string range_text() const;
};

ParameterSpec number_parameter(std::string name, std::string unit, std::string default_value,
                               double min, double max, std::string meaning);
/// As number_parameter, with the lower bound itself refused.
ParameterSpec positive_parameter(std::string name, std::string unit, std::string default_value,
                                 double max, std::string meaning);
ParameterSpec integer_parameter(std::string name, std::string default_value, double min, double max,
                                std::string meaning);
ParameterSpec flag_parameter(std::string name, std::string default_value, std::string meaning);
ParameterSpec choice_parameter(std::string name, std::string default_value,
                               std::vector<std::string> choices, std::string meaning);
/// `spec`, once called `former_name`.
ParameterSpec renamed(ParameterSpec spec, std::string former_name);
/// The one that was once called `name`; null where none was.
const ParameterSpec* find_renamed(const std::vector<ParameterSpec>& specs, const std::string& name);
ParameterSpec vector_parameter(std::string name, std::string unit, std::string default_value,
                               double max_norm, std::string meaning);

/// What `--help` and `pliant list` say of parameters: name, default, range and meaning, two lines
/// each.
std::string describe_parameters(const std::vector<ParameterSpec>& specs);

/// Parameters as a user wrote them: name -> text ("0.5", "true", "[0, 0, -9.81]").
using ParameterText = std::map<std::string, std::string>;

/// Checked parameters with every default filled in.
class Parameters {
 public:
  double number(const std::string& name) const;
  int integer(const std::string& name) const;
  bool flag(const std::string& name) const;
  const std::string& text(const std::string& name) const;
  const Eigen::Vector3d& vector(const std::string& name) const;

  using Value = std::variant<double, bool, std::string, Eigen::Vector3d>;
  void set(const std::string& name, Value value) { values_[name] = std::move(value); }

 private:
  const Value& at(const std::string& name) const;
  std::map<std::string, Value> values_;
};

/// Checks `text` against `specs`. Throws InputError that begins with `where` and names the
/// parameter, what is allowed and, for an unknown name, the nearest one; for a former name, the
/// present one.
Parameters parse_parameters(const std::vector<ParameterSpec>& specs, const ParameterText& text,
                            const std::string& where);

/// "a, b and c" numbers of `text` such as "[1, 2, 3]" or "1 2 3"; throws InputError.
std::vector<double> parse_numbers(const std::string& text, const std::string& where);

/// A finite number; throws InputError when `text` is anything else.
double parse_number(const std::string& text, const std::string& where);

}  // namespace pliant
