// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkSmartPointer.h>

#include "base/image.h"

namespace alidade {

/// Small makers of VTK data, so that the layers speak of sites and not of arrays.

/// Lines between pairs of points.
vtkSmartPointer<vtkPolyData> linesOf(std::span<const glm::vec3> points,
                                     std::span<const std::array<std::uint32_t, 2>> pairs);
/// One line through all points.
vtkSmartPointer<vtkPolyData> polylineOf(std::span<const glm::vec3> points);
/// Every point a vertex; one colour a point, or none.
vtkSmartPointer<vtkPolyData> verticesOf(std::span<const glm::vec3> points, std::span<const glm::u8vec3> colours);
/// Triangles (three indices each), one RGBA colour a triangle.
vtkSmartPointer<vtkPolyData> trianglesOf(std::span<const glm::vec3> points, std::span<const std::uint32_t> indices,
                                         std::span<const Rgba8> colours);

/// An actor of its own mapper, unlit and of one colour unless the data brings colours.
struct LitActor {
  vtkSmartPointer<vtkPolyDataMapper> mapper;
  vtkSmartPointer<vtkActor> actor;
};
LitActor makeActor(const glm::dvec3& colour, bool lit);

}  // namespace alidade
