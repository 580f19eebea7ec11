// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <unistd.h>

#include "cleaning/surface.h"

namespace alidade {

namespace {

template <class T>
void put(std::string& to, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));  // the header names the machine's byte order: little-endian
  to.append(bytes, sizeof(T));
}

void writePly(const SurfaceMesh& mesh, std::ostream& out) {
  out << "ply\nformat binary_little_endian 1.0\ncomment Alidade\nelement vertex " << mesh.vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << mesh.triangles.size()
      << "\nproperty list uchar uint vertex_indices\nend_header\n";
  std::string bytes;
  for (const glm::dvec3& p : mesh.vertices) {
    bytes.clear();
    for (int axis = 0; axis < 3; ++axis) put(bytes, p[axis]);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  for (const auto& triangle : mesh.triangles) {
    bytes.assign(1, '\3');
    for (const std::uint32_t corner : triangle) put(bytes, corner);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
}

void writeObj(const SurfaceMesh& mesh, std::ostream& out) {
  for (const glm::dvec3& p : mesh.vertices) out << fmt::format("v {:.5f} {:.5f} {:.5f}\n", p.x, p.y, p.z);
  for (const auto& t : mesh.triangles) out << fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
}

}  // namespace

Result<void> writeSurface(const SurfaceMesh& mesh, const std::string& path) {
  const bool ply = path.ends_with(".ply"), obj = path.ends_with(".obj");
  if (!ply && !obj) return fail("A surface is written as .ply or .obj", path, "Choose one of these endings");
  const std::string partial = fmt::format("{}.{}.part", path, ::getpid());
  std::ofstream out(partial, std::ios::binary | std::ios::trunc);
  if (ply) writePly(mesh, out);
  else writeObj(mesh, out);
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(partial, path, error);
  if (!out || error) {
    const std::string why = error ? error.message() : std::strerror(errno);
    std::filesystem::remove(partial, error);
    return fail(fmt::format("The surface cannot be written: {}", why), path, "Check the folder and the free space");
  }
  return {};
}

}  // namespace alidade
