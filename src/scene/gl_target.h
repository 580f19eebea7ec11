// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkSmartPointer.h>

#include "scene/site_view.h"

namespace alidade {

/// VTK's render window inside an OpenGL context that a widget owns. VTK draws into framebuffers of
/// its own; `paint` copies the picture into the widget's and puts the context's state back.
class GlTarget {
 public:
  GlTarget();
  ~GlTarget();
  GlTarget(const GlTarget&) = delete;
  GlTarget& operator=(const GlTarget&) = delete;

  vtkGenericOpenGLRenderWindow* window() const { return m_window; }
  void attach(const SceneContext& context);
  void release();
  bool attached() const { return m_attached; }
  /// True where no graphics hardware is behind the context; known once attached.
  bool isSoftware() const { return m_isSoftware; }
  void paint(unsigned framebuffer, int width, int height);

 private:
  vtkSmartPointer<vtkGenericOpenGLRenderWindow> m_window;
  SceneContext m_context;
  bool m_attached = false;
  bool m_isSoftware = true;
};

}  // namespace alidade
