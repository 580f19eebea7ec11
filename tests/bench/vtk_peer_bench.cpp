// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// The peer: the same twenty million points through VTK's own poly-vertex mapper, off screen, without a lens
// (it has none). Needs a display or xvfb-run.

#include <cmath>
#include <cstdlib>

#include <benchmark/benchmark.h>

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>

#include "bench/site.h"

namespace alidade {
namespace {

using test::cpuSeconds;
using test::siteOf;

/// One vertex cell of all points, relative to the site's corner.
vtkSmartPointer<vtkPolyData> polyVertexOf(const PointStore& store, const glm::dvec3& origin) {
  const auto count = static_cast<vtkIdType>(store.pointCount());
  vtkNew<vtkPoints> points;
  points->SetDataTypeToFloat();
  points->SetNumberOfPoints(count);
  vtkNew<vtkUnsignedCharArray> colours;
  colours->SetNumberOfComponents(3);
  colours->SetNumberOfTuples(count);
  for (const CloudNode& node : store.nodes()) {
    for (std::uint64_t i = node.first; i < node.first + node.count; ++i) {
      const DisplayPoint& p = store.points()[i];
      const glm::dvec3 at = node.origin + node.step * glm::dvec3(p.x, p.y, p.z) - origin;
      points->SetPoint(static_cast<vtkIdType>(i), at.x, at.y, at.z);
      const unsigned char rgb[3] = {static_cast<unsigned char>(p.rgb565 >> 11 << 3),
                                    static_cast<unsigned char>((p.rgb565 >> 5 & 63) << 2),
                                    static_cast<unsigned char>((p.rgb565 & 31) << 3)};
      colours->SetTypedTuple(static_cast<vtkIdType>(i), rgb);
    }
  }
  vtkNew<vtkCellArray> vertices;
  vertices->InsertNextCell(static_cast<int>(count));
  for (vtkIdType i = 0; i < count; ++i) vertices->InsertCellPoint(i);
  auto cloud = vtkSmartPointer<vtkPolyData>::New();
  cloud->SetPoints(points);
  cloud->SetVerts(vertices);
  cloud->GetPointData()->SetScalars(colours);
  return cloud;
}

void splat_vtk_20M(benchmark::State& state) {
  if (!std::getenv("DISPLAY")) {
    state.SkipWithError("VTK needs a display: run under xvfb-run");
    return;
  }
  const auto store = siteOf(20'000'000);
  const glm::dvec3 origin(402100, 5655000, 110);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(polyVertexOf(*store, origin));
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkNew<vtkRenderer> renderer;
  renderer->AddActor(actor);
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetSize(1920, 1080);
  window->AddRenderer(renderer);
  // The overview of the other rows.
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetPosition(0, -130, 80);
  camera->SetFocalPoint(0, 85, 0);
  camera->SetViewUp(0, 0, 1);
  camera->SetViewAngle(2 * 57.29577951 * std::atan(540.0 / 1150.0));
  renderer->ResetCameraClippingRange();
  window->Render();  // the upload
  window->WaitForCompletion();
  const double start = cpuSeconds();
  for (auto _ : state) {
    window->Render();
    window->WaitForCompletion();
  }
  state.counters["cpu_ms"] = 1e3 * (cpuSeconds() - start) / static_cast<double>(state.iterations());
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * store->pointCount()));
  state.SetLabel("VTK poly-vertex, no lens");
}

BENCHMARK(splat_vtk_20M)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace alidade
