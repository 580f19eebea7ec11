// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/blue_noise_pass_body.h"

#if defined(__x86_64__)
namespace alidade::blue_noise {

std::size_t chooseAvx2(const Pass& pass) {
  return Choice(pass).run();
}

}  // namespace alidade::blue_noise
#endif
