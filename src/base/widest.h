// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

/// Before a function whose loops are plain arithmetic: it is compiled for several widths of register, and the widest that the
/// processor has is chosen when the program starts. Not where addresses are checked: the choice is made before the checks can work.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define ALIDADE_WIDEST __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define ALIDADE_WIDEST
#endif
