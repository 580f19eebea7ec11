// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/version.h"

namespace alidade {

const char* softwareName() {
  return "Alidade " ALIDADE_VERSION;
}

const char* softwareVersion() {
  return ALIDADE_VERSION;
}

}  // namespace alidade
