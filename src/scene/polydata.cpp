// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "scene/polydata.h"

#include <cstring>
#include <numeric>

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

namespace alidade {

namespace {

vtkSmartPointer<vtkPolyData> withPoints(std::span<const glm::vec3> points) {
  auto array = vtkSmartPointer<vtkFloatArray>::New();
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(static_cast<vtkIdType>(points.size()));
  if (!points.empty()) std::memcpy(array->GetPointer(0), points.data(), points.size_bytes());
  auto vtk = vtkSmartPointer<vtkPoints>::New();
  vtk->SetData(array);
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(vtk);
  return data;
}

/// Cells of `corners` points each, their points one after another in `connectivity`.
vtkSmartPointer<vtkCellArray> cellsOf(vtkIdTypeArray* connectivity, vtkIdType corners) {
  auto offsets = vtkSmartPointer<vtkIdTypeArray>::New();
  const vtkIdType cells = corners > 0 ? connectivity->GetNumberOfValues() / corners : 0;
  offsets->SetNumberOfValues(cells + 1);
  for (vtkIdType i = 0; i <= cells; ++i) offsets->SetValue(i, i * corners);
  auto array = vtkSmartPointer<vtkCellArray>::New();
  array->SetData(offsets, connectivity);
  return array;
}

vtkSmartPointer<vtkIdTypeArray> countUp(std::size_t count) {
  auto ids = vtkSmartPointer<vtkIdTypeArray>::New();
  ids->SetNumberOfValues(static_cast<vtkIdType>(count));
  std::iota(ids->GetPointer(0), ids->GetPointer(0) + count, vtkIdType{0});
  return ids;
}

}  // namespace

vtkSmartPointer<vtkPolyData> linesOf(std::span<const glm::vec3> points,
                                     std::span<const std::array<std::uint32_t, 2>> pairs) {
  auto data = withPoints(points);
  auto ids = vtkSmartPointer<vtkIdTypeArray>::New();
  ids->SetNumberOfValues(static_cast<vtkIdType>(2 * pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    ids->SetValue(static_cast<vtkIdType>(2 * i), pairs[i][0]);
    ids->SetValue(static_cast<vtkIdType>(2 * i + 1), pairs[i][1]);
  }
  data->SetLines(cellsOf(ids, 2));
  return data;
}

vtkSmartPointer<vtkPolyData> polylineOf(std::span<const glm::vec3> points) {
  auto data = withPoints(points);
  if (points.size() > 1) data->SetLines(cellsOf(countUp(points.size()), static_cast<vtkIdType>(points.size())));
  return data;
}

vtkSmartPointer<vtkPolyData> verticesOf(std::span<const glm::vec3> points, std::span<const glm::u8vec3> colours) {
  auto data = withPoints(points);
  // One cell of many vertices: a million cells of one cost more than the points themselves.
  if (!points.empty()) data->SetVerts(cellsOf(countUp(points.size()), static_cast<vtkIdType>(points.size())));
  if (colours.size() == points.size() && !points.empty()) {
    auto array = vtkSmartPointer<vtkUnsignedCharArray>::New();
    array->SetNumberOfComponents(3);
    array->SetNumberOfTuples(static_cast<vtkIdType>(colours.size()));
    std::memcpy(array->GetPointer(0), colours.data(), colours.size_bytes());
    data->GetPointData()->SetScalars(array);
  }
  return data;
}

vtkSmartPointer<vtkPolyData> trianglesOf(std::span<const glm::vec3> points, std::span<const std::uint32_t> indices,
                                         std::span<const Rgba8> colours) {
  auto data = withPoints(points);
  auto ids = vtkSmartPointer<vtkIdTypeArray>::New();
  ids->SetNumberOfValues(static_cast<vtkIdType>(indices.size()));
  for (std::size_t i = 0; i < indices.size(); ++i) ids->SetValue(static_cast<vtkIdType>(i), indices[i]);
  data->SetPolys(cellsOf(ids, 3));
  if (colours.size() * 3 == indices.size() && !colours.empty()) {
    auto array = vtkSmartPointer<vtkUnsignedCharArray>::New();
    array->SetNumberOfComponents(4);
    array->SetNumberOfTuples(static_cast<vtkIdType>(colours.size()));
    std::memcpy(array->GetPointer(0), colours.data(), colours.size_bytes());
    data->GetCellData()->SetScalars(array);
  }
  return data;
}

LitActor makeActor(const glm::dvec3& colour, bool lit) {
  LitActor made{vtkSmartPointer<vtkPolyDataMapper>::New(), vtkSmartPointer<vtkActor>::New()};
  made.mapper->SetStatic(1);
  made.actor->SetMapper(made.mapper);
  made.actor->GetProperty()->SetColor(colour.r, colour.g, colour.b);
  made.actor->GetProperty()->SetLighting(lit);
  made.actor->SetPickable(0);
  return made;
}

}  // namespace alidade
