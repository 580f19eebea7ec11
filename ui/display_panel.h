// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "ui/settings_form.h"

namespace alidade {

/// How the frame is drawn: passes, design, light. What concerns the scan's points has its own page.
class DisplayPanel : public SettingsForm {
  Q_OBJECT

 public:
  explicit DisplayPanel(Session& session, QWidget* parent = nullptr);
};

}  // namespace alidade
