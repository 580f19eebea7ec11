// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/start.h"

#include <QCoreApplication>
#include <QSurfaceFormat>
#include <QtGlobal>

/// A static library's resources are dropped by the linker unless someone asks for them.
static void loadResources() {
  Q_INIT_RESOURCE(window);
}

namespace alidade {

void prepareGraphics() {
  QCoreApplication::setAttribute(Qt::AA_ShareOpenGLContexts);
  QSurfaceFormat format;
  format.setRenderableType(QSurfaceFormat::OpenGL);
  format.setVersion(3, 2);
  format.setProfile(QSurfaceFormat::CoreProfile);
  format.setDepthBufferSize(24);
  format.setStencilBufferSize(8);
  format.setSamples(0);
  QSurfaceFormat::setDefaultFormat(format);
}

void nameApplication() {
  loadResources();
  QCoreApplication::setOrganizationName(QStringLiteral("Alidade"));
  QCoreApplication::setApplicationName(QStringLiteral("alidade"));
  QCoreApplication::setApplicationVersion(QStringLiteral(ALIDADE_VERSION));
}

}  // namespace alidade
