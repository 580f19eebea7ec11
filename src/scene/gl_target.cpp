// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "scene/gl_target.h"

#include <string_view>

#include <vtk_glew.h>

#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkOpenGLFramebufferObject.h>
#include <vtkOpenGLState.h>

namespace alidade {

namespace {

/// VTK asks about the context by events, because it did not make it.
void answer(vtkObject*, unsigned long event, void* clientData, void* callData) {
  const auto* context = static_cast<const SceneContext*>(clientData);
  switch (event) {
    case vtkCommand::WindowMakeCurrentEvent:
      if (context->makeCurrent) context->makeCurrent();
      break;
    case vtkCommand::WindowIsCurrentEvent:
      *static_cast<bool*>(callData) = context->isCurrent && context->isCurrent();
      break;
    case vtkCommand::WindowSupportsOpenGLEvent:
    case vtkCommand::WindowIsDirectEvent:
      *static_cast<int*>(callData) = 1;
      break;
    default:
      break;
  }
}

}  // namespace

GlTarget::GlTarget() : m_window(vtkSmartPointer<vtkGenericOpenGLRenderWindow>::New()) {
  auto command = vtkSmartPointer<vtkCallbackCommand>::New();
  command->SetCallback(answer);
  command->SetClientData(&m_context);
  for (const auto event : {vtkCommand::WindowMakeCurrentEvent, vtkCommand::WindowIsCurrentEvent,
                           vtkCommand::WindowSupportsOpenGLEvent, vtkCommand::WindowIsDirectEvent})
    m_window->AddObserver(event, command);
  // Core profiles draw no line wider than a pixel; VTK widens them in a geometry shader if told so.
  m_window->SetForceMaximumHardwareLineWidth(1);
  m_window->SetFrameBlitModeToNoBlit();
  m_window->SetReadyForRendering(false);
  m_window->SetMultiSamples(0);
  m_window->SetOwnContext(0);
}

GlTarget::~GlTarget() {
  release();
  m_window->RemoveAllObservers();
}

void GlTarget::attach(const SceneContext& context) {
  if (m_attached) release();
  m_context = context;
  m_window->SetReadyForRendering(true);
  m_window->SetOwnContext(0);
  m_window->OpenGLInitContext();
  m_window->OpenGLInit();
  m_window->SetMapped(1);
  m_attached = true;
  const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  const std::string_view renderer = name != nullptr ? name : "";
  m_isSoftware = renderer.find("llvmpipe") != std::string_view::npos ||
                 renderer.find("softpipe") != std::string_view::npos ||
                 renderer.find("SwiftShader") != std::string_view::npos;
  m_window->SetMultiSamples(m_isSoftware ? 0 : 4);
}

void GlTarget::release() {
  if (!m_attached) return;
  if (m_context.makeCurrent) m_context.makeCurrent();
  m_window->Finalize();
  m_window->SetReadyForRendering(false);
  m_context = {};
  m_attached = false;
}

void GlTarget::paint(unsigned framebuffer, int width, int height) {
  vtkOpenGLState* state = m_window->GetState();
  // The widget's toolkit changed the state since; VTK must not trust what it remembers.
  state->Reset();
  state->Push();
  state->vtkglDepthFunc(GL_LEQUAL);
  m_window->Render();
  state->vtkglBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  state->vtkglDrawBuffer(framebuffer != 0 ? GL_COLOR_ATTACHMENT0 : GL_BACK);
  state->vtkglViewport(0, 0, width, height);
  state->vtkglDisable(GL_SCISSOR_TEST);
  m_window->BlitDisplayFramebuffer(0, 0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  state->vtkglBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  // A widget with alpha below 1 would let the desktop shine through.
  state->vtkglColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_TRUE);
  state->vtkglClearColor(0, 0, 0, 1);
  state->vtkglClear(GL_COLOR_BUFFER_BIT);
  state->vtkglColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  state->Pop();
  state->vtkglBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
}

}  // namespace alidade
