// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>

#include <vtkProp.h>
#include <vtkSmartPointer.h>

#include "base/image.h"

class vtkOpenGLQuadHelper;
class vtkTextureObject;

namespace alidade {

/// A picture with depths that was drawn elsewhere for the renderer's own camera, among the things that VTK draws: each pixel hides
/// and is hidden by its depth. The picture's size is the window's.
class PictureProp : public vtkProp {
 public:
  vtkTypeMacro(PictureProp, vtkProp);
  static PictureProp* New();

  /// Depth in metres along the axis; where it is +inf nothing is drawn.
  void set(DepthImage depth, ColourImage colour);

  int RenderOpaqueGeometry(vtkViewport* viewport) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;

 protected:
  PictureProp();
  ~PictureProp() override;

 private:
  DepthImage m_depth;
  ColourImage m_colour;
  bool m_uploaded = false;
  vtkSmartPointer<vtkTextureObject> m_depthTexture, m_colourTexture;
  std::unique_ptr<vtkOpenGLQuadHelper> m_quad;
};

}  // namespace alidade
