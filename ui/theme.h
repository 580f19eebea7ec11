// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QColor>
#include <QIcon>
#include <QString>

class QApplication;

namespace alidade {

enum class Theme { Dark, Light, HighContrast };

/// The colours that widgets paint with by hand; everything else follows QPalette.
struct ThemeColours {
  QColor ground, panel, raised, line, text, dimText, accent, onAccent, pictureGround;
  QColor good, caution, bad;
};

/// Dark neutral grey, so that the picture is judged without a bright frame; light; high contrast.
void applyTheme(QApplication& application, Theme theme);
Theme currentTheme();
const ThemeColours& colours();
QString themeName(Theme theme);  ///< as stored in the settings: "dark", "light", "contrast"
Theme themeNamed(const QString& name);

/// The three sizes: small (labels beside figures), body, title.
QFont smallFont();
QFont bodyFont();
QFont titleFont();

/// An icon of our set, resources/icons/<name>.svg, drawn in the theme's text colour at any size; in the
/// accent while it is on (a checked tool), unless `plain` (a tree shows open rows as on).
QIcon icon(const QString& name, bool plain = false);

}  // namespace alidade
