#include "pliant/models/reduced/files/reduced_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr char kMagic[] = "PLIANTRM";
constexpr std::uint32_t kByteOrder = 0x01020304;
constexpr std::size_t kHeaderBytes = 8 + 4 + 4 + 8 + 8;
constexpr std::uint32_t kMaxNameBytes = 1000;

std::uint64_t fnv1a(const char* bytes, std::size_t count) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (std::size_t k = 0; k < count; ++k) {
    hash = (hash ^ static_cast<unsigned char>(bytes[k])) * 0x100000001b3ull;
  }
  return hash;
}

class Writer {
 public:
  template <class T>
  void value(T value) {
    array(&value, 1);
  }
  template <class T>
  void array(const T* values, std::size_t count) {
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class Reader {
 public:
  Reader(const std::string& bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  template <class T>
  T value() {
    T value;
    array(&value, 1);
    return value;
  }
  template <class T>
  void array(T* values, std::size_t count) {
    expect(count, sizeof(T));
    if (count == 0) return;  // then there may be no values to point to
    std::memcpy(values, bytes_.data() + next_, count * sizeof(T));
    next_ += count * sizeof(T);
  }
  /// Refuses before memory is taken for what is not there.
  void expect(std::size_t count, std::size_t size) const {
    if (count > (bytes_.size() - next_) / size) refuse("is shorter than its contents need");
  }
  bool at_end() const { return next_ == bytes_.size(); }
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("reduced model '{}' {}", path_, what));
  }

 private:
  const std::string& bytes_;
  const std::string& path_;
  std::size_t next_ = 0;
};

std::string read_file(const std::string& path) {
  std::error_code error;
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error)) {
    throw InputError(fmt::format("cannot read reduced model '{}': it is no regular file", path));
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw InputError(fmt::format("cannot read reduced model '{}': {}", path, std::strerror(errno)));
  }
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The file's version.
std::uint32_t check_header(Reader& reader, const std::string& bytes) {
  char magic[8];
  reader.array(magic, sizeof magic);
  if (std::memcmp(magic, kMagic, sizeof magic) != 0) {
    reader.refuse("is no such file: it does not begin with PLIANTRM");
  }
  const auto version = reader.value<std::uint32_t>();
  const auto order = reader.value<std::uint32_t>();
  if (order != kByteOrder) reader.refuse("was written with another byte order");
  if (version < 1 || version > kReducedFileVersion) {
    reader.refuse(
        fmt::format("has version {}, but 1 to {} are read: make it anew with `pliant reduce`",
                    version, kReducedFileVersion));
  }
  const auto size = reader.value<std::uint64_t>();
  const auto checksum = reader.value<std::uint64_t>();
  if (size != bytes.size() - kHeaderBytes) {
    reader.refuse(fmt::format("is truncated or altered: {} bytes of {} are there",
                              bytes.size() - kHeaderBytes, size));
  }
  if (checksum != fnv1a(bytes.data() + kHeaderBytes, bytes.size() - kHeaderBytes)) {
    reader.refuse("is altered: its checksum differs");
  }
  return version;
}

void read_mesh(Reader& reader, std::size_t n, std::size_t m, ReducedModel& model) {
  reader.expect(3 * n, sizeof(double));
  model.mesh.vertices.resize(3, static_cast<Eigen::Index>(n));
  reader.array(model.mesh.vertices.data(), 3 * n);
  reader.expect(4 * m, sizeof(std::int32_t));
  model.mesh.tetrahedra.resize(4, static_cast<Eigen::Index>(m));
  reader.array(model.mesh.tetrahedra.data(), 4 * m);
  std::vector<std::uint8_t> fixed(n);
  reader.array(fixed.data(), n);
  model.fixed.assign(fixed.begin(), fixed.end());
}

void read_surface(Reader& reader, const std::string& where, TriangleMesh& surface) {
  const std::size_t vertices = reader.value<std::uint32_t>();
  const std::size_t triangles = reader.value<std::uint32_t>();
  reader.expect(3 * vertices, sizeof(double));
  surface.vertices.resize(3, static_cast<Eigen::Index>(vertices));
  reader.array(surface.vertices.data(), 3 * vertices);
  reader.expect(3 * triangles, sizeof(std::int32_t));
  surface.triangles.resize(3, static_cast<Eigen::Index>(triangles));
  reader.array(surface.triangles.data(), 3 * triangles);
  if (vertices > 0 || triangles > 0) validate(surface, where + ": surface");
}

void check_basis(const Reader& reader, const ReducedModel& model) {
  if (!model.basis.allFinite()) reader.refuse("has a basis that is not finite");
  for (std::size_t v = 0; v < model.fixed.size(); ++v) {
    if (!model.fixed[v]) continue;
    if (model.basis.middleRows(3 * static_cast<Eigen::Index>(v), 3).isZero(0.0)) continue;
    reader.refuse(fmt::format("has a basis that moves the fixed vertex {}", v));
  }
}

}  // namespace

void write_reduced_model(const std::string& path, const ReducedModel& model) {
  static_assert(sizeof(int) == sizeof(std::int32_t));
  Writer body;
  body.value(static_cast<std::uint32_t>(model.name.size()));
  body.array(model.name.data(), model.name.size());
  body.value(model.material.young);
  body.value(model.material.poisson);
  body.value(model.material.density);
  body.value(static_cast<std::uint32_t>(model.modes));
  body.value(static_cast<std::uint32_t>(model.mesh.vertices.cols()));
  body.value(static_cast<std::uint32_t>(model.mesh.tetrahedra.cols()));
  body.value(static_cast<std::uint32_t>(model.rank()));
  body.array(model.mesh.vertices.data(), static_cast<std::size_t>(model.mesh.vertices.size()));
  body.array(model.mesh.tetrahedra.data(), static_cast<std::size_t>(model.mesh.tetrahedra.size()));
  for (const bool fixed : model.fixed) body.value(static_cast<std::uint8_t>(fixed ? 1 : 0));
  body.array(model.basis.data(), static_cast<std::size_t>(model.basis.size()));
  body.array(model.potential.lambda().data(), static_cast<std::size_t>(model.rank()));
  const std::vector<double> coefficients = model.potential.coefficients();
  body.array(coefficients.data(), coefficients.size());
  body.value(static_cast<std::uint32_t>(model.surface.vertices.cols()));
  body.value(static_cast<std::uint32_t>(model.surface.triangles.cols()));
  body.array(model.surface.vertices.data(),
             static_cast<std::size_t>(model.surface.vertices.size()));
  body.array(model.surface.triangles.data(),
             static_cast<std::size_t>(model.surface.triangles.size()));
  Writer file;
  file.array(kMagic, 8);
  file.value(kReducedFileVersion);
  file.value(kByteOrder);
  file.value(static_cast<std::uint64_t>(body.bytes().size()));
  file.value(fnv1a(body.bytes().data(), body.bytes().size()));
  write_file_atomically(path, file.bytes() + body.bytes());
}

ReducedModel read_reduced_model(const std::string& path) {
  const std::string bytes = read_file(path);
  Reader reader(bytes, path);
  const std::uint32_t version = check_header(reader, bytes);
  const std::string where = fmt::format("reduced model '{}'", path);
  ReducedModel model;
  const auto name_bytes = reader.value<std::uint32_t>();
  if (name_bytes > kMaxNameBytes) reader.refuse("has too long a name");
  model.name.resize(name_bytes);
  reader.array(model.name.data(), name_bytes);
  model.material.young = reader.value<double>();
  model.material.poisson = reader.value<double>();
  model.material.density = reader.value<double>();
  model.modes = static_cast<int>(reader.value<std::uint32_t>());
  const std::size_t n = reader.value<std::uint32_t>(), m = reader.value<std::uint32_t>();
  const std::size_t rank = reader.value<std::uint32_t>();
  if (rank < 1 || rank > static_cast<std::size_t>(kMaxRank)) {
    reader.refuse(fmt::format("has rank {}, but it must be from 1 to {}", rank, kMaxRank));
  }
  read_mesh(reader, n, m, model);
  validate(model.mesh, where);
  reader.expect(3 * n * rank, sizeof(double));
  model.basis.resize(3 * static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(rank));
  reader.array(model.basis.data(), 3 * n * rank);
  check_basis(reader, model);
  Eigen::VectorXd lambda(static_cast<Eigen::Index>(rank));
  reader.array(lambda.data(), rank);
  const auto count =
      static_cast<std::size_t>(QuarticPotential::coefficient_count(static_cast<int>(rank)));
  reader.expect(count, sizeof(double));
  std::vector<double> coefficients(count);
  reader.array(coefficients.data(), count);
  if (version > 1) read_surface(reader, where, model.surface);
  if (!reader.at_end()) reader.refuse("is longer than its contents need");
  model.potential = QuarticPotential(lambda, coefficients, where);
  return model;
}

}  // namespace pliant
