// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/blue_noise_pass_body.h"

namespace alidade::blue_noise {

std::size_t chooseScalar(const Pass& pass) {
  return Choice(pass).run();
}

}  // namespace alidade::blue_noise
