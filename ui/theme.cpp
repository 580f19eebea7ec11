// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/theme.h"

#include <QApplication>
#include <QFile>
#include <QFontDatabase>
#include <QIconEngine>
#include <QPainter>
#include <QPalette>
#include <QRegularExpression>
#include <QSvgRenderer>

#include "ui/theme_style.h"

namespace alidade {

namespace {

Theme g_theme = Theme::Dark;
ThemeColours g_colours;

ThemeColours coloursOf(Theme theme) {
  switch (theme) {
    case Theme::Light:
      return {QColor(QRgb(0xE9E9E9)), QColor(QRgb(0xF5F5F5)), QColor(QRgb(0xFFFFFF)), QColor(QRgb(0xC4C4C4)),
              QColor(QRgb(0x1B1B1B)), QColor(QRgb(0x5A5A5A)), QColor(QRgb(0x0B63A8)), QColor(QRgb(0xFFFFFF)),
              QColor(QRgb(0xC9C9C9)), QColor(QRgb(0x1B7A3A)), QColor(QRgb(0x9A6200)), QColor(QRgb(0xB3261E))};
    case Theme::HighContrast:
      return {QColor(QRgb(0x000000)), QColor(QRgb(0x000000)), QColor(QRgb(0x141414)), QColor(QRgb(0xFFFFFF)),
              QColor(QRgb(0xFFFFFF)), QColor(QRgb(0xE4E4E4)), QColor(QRgb(0xFFD500)), QColor(QRgb(0x000000)),
              QColor(QRgb(0x000000)), QColor(QRgb(0x5CFF9A)), QColor(QRgb(0xFFD500)), QColor(QRgb(0xFF8A80))};
    case Theme::Dark:
      break;
  }
  return {QColor(QRgb(0x262626)), QColor(QRgb(0x2D2D2D)), QColor(QRgb(0x3A3A3A)), QColor(QRgb(0x454545)),
          QColor(QRgb(0xE4E4E4)), QColor(QRgb(0xA6A6A6)), QColor(QRgb(0x4FA3E0)), QColor(QRgb(0x101010)),
          QColor(QRgb(0x1C1C1C)), QColor(QRgb(0x62C48A)), QColor(QRgb(0xE8B34A)), QColor(QRgb(0xF0857D))};
}

QPalette paletteOf(const ThemeColours& c) {
  QPalette p;
  p.setColor(QPalette::Window, c.panel);
  p.setColor(QPalette::WindowText, c.text);
  p.setColor(QPalette::Base, c.ground);
  p.setColor(QPalette::AlternateBase, c.panel);
  p.setColor(QPalette::Text, c.text);
  p.setColor(QPalette::PlaceholderText, c.dimText);
  p.setColor(QPalette::Button, c.raised);
  p.setColor(QPalette::ButtonText, c.text);
  p.setColor(QPalette::BrightText, c.bad);
  p.setColor(QPalette::ToolTipBase, c.raised);
  p.setColor(QPalette::ToolTipText, c.text);
  p.setColor(QPalette::Highlight, c.accent);
  p.setColor(QPalette::HighlightedText, c.onAccent);
  p.setColor(QPalette::Link, c.accent);
  p.setColor(QPalette::Mid, c.line);
  p.setColor(QPalette::Dark, c.line);
  p.setColor(QPalette::Light, c.raised);
  p.setColor(QPalette::Midlight, c.raised);
  p.setColor(QPalette::Shadow, Qt::black);
  for (const auto role :
       {QPalette::WindowText, QPalette::Text, QPalette::ButtonText, QPalette::HighlightedText}) {
    QColor faint = c.dimText;
    faint.setAlpha(140);
    p.setColor(QPalette::Disabled, role, faint);
  }
  p.setColor(QPalette::Disabled, QPalette::Highlight, c.line);
  return p;
}

QString styleSheetOf(const ThemeColours& c) {
  QFile file(QStringLiteral(":/styles/alidade.qss"));
  if (!file.open(QIODevice::ReadOnly)) return {};
  QString sheet = QString::fromUtf8(file.readAll());
  const std::pair<const char*, QColor> names[] = {
      {"@ground", c.ground}, {"@panel", c.panel},       {"@raised", c.raised},
      {"@line", c.line},     {"@text", c.text},         {"@dimText", c.dimText},
      {"@accent", c.accent}, {"@onAccent", c.onAccent}, {"@bad", c.bad}};
  for (const auto& [name, colour] : names) {
    // Whole words only: @text is no part of @textured.
    sheet.replace(QRegularExpression(QString::fromLatin1(name) + QStringLiteral("\\b")), colour.name());
  }
  return sheet;
}

/// Paints the SVG at the very size asked for: crisp at 16 px, at 200 % and in between.
class SvgIconEngine : public QIconEngine {
 public:
  SvgIconEngine(const QString& name, bool plain) : m_plain(plain) {
    QFile file(QStringLiteral(":/icons/%1.svg").arg(name));
    if (file.open(QIODevice::ReadOnly)) m_source = file.readAll();
  }
  QIconEngine* clone() const override { return new SvgIconEngine(*this); }

  void paint(QPainter* painter, const QRect& rect, QIcon::Mode mode, QIcon::State state) override {
    QColor colour = colours().text;
    if (mode == QIcon::Disabled) {
      colour = colours().dimText;
      colour.setAlpha(120);
    } else if (state == QIcon::On && !m_plain) {
      colour = colours().accent;
    }
    QByteArray svg = m_source;
    svg.replace("currentColor", colour.name().toLatin1());
    QSvgRenderer renderer(svg);
    painter->setOpacity(colour.alphaF());
    renderer.render(painter, rect);
    painter->setOpacity(1.0);
  }

  QPixmap pixmap(const QSize& size, QIcon::Mode mode, QIcon::State state) override {
    QPixmap picture(size);
    picture.fill(Qt::transparent);
    QPainter painter(&picture);
    paint(&painter, QRect(QPoint(0, 0), size), mode, state);
    return picture;
  }

 private:
  bool m_plain;
  QByteArray m_source;
};

}  // namespace

void applyTheme(QApplication& application, Theme theme) {
  g_theme = theme;
  g_colours = coloursOf(theme);
  static const bool styled = [&] {
    application.setStyle(new ThemeStyle);
    return true;
  }();
  Q_UNUSED(styled);
  application.setFont(bodyFont());
  application.setPalette(paletteOf(g_colours));
  application.setStyleSheet(styleSheetOf(g_colours));
}

Theme currentTheme() {
  return g_theme;
}

const ThemeColours& colours() {
  return g_colours;
}

QString themeName(Theme theme) {
  switch (theme) {
    case Theme::Dark:
      return QStringLiteral("dark");
    case Theme::Light:
      return QStringLiteral("light");
    case Theme::HighContrast:
      return QStringLiteral("contrast");
  }
  return {};
}

Theme themeNamed(const QString& name) {
  if (name == themeName(Theme::Light)) return Theme::Light;
  if (name == themeName(Theme::HighContrast)) return Theme::HighContrast;
  return Theme::Dark;
}

namespace {

// Faces whose figures all have one width, so that running numbers do not jitter.
QFont fontOfPixels(int pixels, bool strong = false) {
  static const QString family = [] {
    const QStringList installed = QFontDatabase::families();
    for (const char* wanted : {"Open Sans", "Noto Sans", "Liberation Sans", "DejaVu Sans"})
      if (installed.contains(QString::fromLatin1(wanted))) return QString::fromLatin1(wanted);
    return QFontDatabase::systemFont(QFontDatabase::GeneralFont).family();
  }();
  QFont font(family);
  font.setPixelSize(pixels);
  if (strong) font.setWeight(QFont::DemiBold);
  return font;
}

}  // namespace

QFont smallFont() {
  return fontOfPixels(11);
}

QFont bodyFont() {
  return fontOfPixels(13);
}

QFont titleFont() {
  return fontOfPixels(18, true);
}

QIcon icon(const QString& name, bool plain) {
  return QIcon(new SvgIconEngine(name, plain));
}

}  // namespace alidade
