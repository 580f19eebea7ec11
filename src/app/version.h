// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace alidade {

/// "Alidade 0.1.0"
const char* softwareName();
/// "0.1.0"
const char* softwareVersion();

}  // namespace alidade
