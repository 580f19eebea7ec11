// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "scene/picture_prop.h"

#include <utility>

#include <vtkCamera.h>
#include <vtkObjectFactory.h>
#include <vtkOpenGLQuadHelper.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLShaderCache.h>
#include <vtkRenderer.h>
#include <vtkShaderProgram.h>
#include <vtkTextureObject.h>

namespace alidade {

namespace {

// Depth as a perspective projection between the two planes has it.
constexpr const char* kShader = R"(//VTK::System::Dec
in vec2 texCoord;
uniform sampler2D depths;
uniform sampler2D colours;
uniform float nearest;
uniform float farthest;
//VTK::Output::Dec
void main() {
  ivec2 at = ivec2(vec2(texCoord.x, 1.0 - texCoord.y) * vec2(textureSize(depths, 0)));  // pictures begin at the top
  float z = texelFetch(depths, at, 0).r;
  if (!(z >= nearest && z < farthest)) discard;
  gl_FragDepth = farthest * (z - nearest) / (z * (farthest - nearest));
  gl_FragData[0] = vec4(texelFetch(colours, at, 0).rgb, 1.0);
}
)";

}  // namespace

vtkStandardNewMacro(PictureProp);

PictureProp::PictureProp() : m_depthTexture(vtkSmartPointer<vtkTextureObject>::New()), m_colourTexture(vtkSmartPointer<vtkTextureObject>::New()) {}
PictureProp::~PictureProp() = default;

void PictureProp::set(DepthImage depth, ColourImage colour) {
  m_depth = std::move(depth);
  m_colour = std::move(colour);
  m_uploaded = false;
  Modified();
}

int PictureProp::RenderOpaqueGeometry(vtkViewport* viewport) {
  auto* renderer = vtkRenderer::SafeDownCast(viewport);
  auto* window = renderer ? vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()) : nullptr;
  if (!window || m_depth.empty()) return 0;
  if (!m_uploaded) {
    const auto width = static_cast<unsigned>(m_depth.width()), height = static_cast<unsigned>(m_depth.height());
    for (vtkTextureObject* texture : {m_depthTexture.Get(), m_colourTexture.Get()}) {
      texture->SetContext(window);
      texture->SetMinificationFilter(vtkTextureObject::Nearest);
      texture->SetMagnificationFilter(vtkTextureObject::Nearest);
    }
    m_uploaded = m_depthTexture->Create2DFromRaw(width, height, 1, VTK_FLOAT, m_depth.data()) &&
                 m_colourTexture->Create2DFromRaw(width, height, 4, VTK_UNSIGNED_CHAR, m_colour.data());
    if (!m_uploaded) return 0;
  }
  if (m_quad) window->GetShaderCache()->ReadyShaderProgram(m_quad->Program);
  else m_quad = std::make_unique<vtkOpenGLQuadHelper>(window, nullptr, kShader, "");
  vtkShaderProgram* program = m_quad->Program;
  if (!program || !program->GetCompiled()) return 0;
  m_depthTexture->Activate();
  m_colourTexture->Activate();
  program->SetUniformi("depths", m_depthTexture->GetTextureUnit());
  program->SetUniformi("colours", m_colourTexture->GetTextureUnit());
  const double* range = renderer->GetActiveCamera()->GetClippingRange();
  program->SetUniformf("nearest", static_cast<float>(range[0]));
  program->SetUniformf("farthest", static_cast<float>(range[1]));
  m_quad->Render();
  m_colourTexture->Deactivate();
  m_depthTexture->Deactivate();
  return 1;
}

void PictureProp::ReleaseGraphicsResources(vtkWindow* window) {
  if (m_quad) m_quad->ReleaseGraphicsResources(window);
  m_quad.reset();
  m_depthTexture->ReleaseGraphicsResources(window);
  m_colourTexture->ReleaseGraphicsResources(window);
  m_uploaded = false;
  vtkProp::ReleaseGraphicsResources(window);
}

}  // namespace alidade
