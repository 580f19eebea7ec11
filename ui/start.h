// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace alidade {

/// Before the QApplication: shared contexts (an undocked 3D view would turn black) and the surface
/// that VTK needs (core 3.2, 24 bit depth, 8 bit stencil, no samples).
void prepareGraphics();

/// After it: names that the settings and data folders go by, and the readers' plugins.
void nameApplication();

}  // namespace alidade
