// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/calibration_report.h"

#include <filesystem>
#include <span>

#include <QBuffer>
#include <QFont>
#include <QImage>
#include <QPageSize>
#include <QPainter>
#include <QPdfWriter>
#include <QString>
#include <fmt/format.h>

#include "io/atomic_file.h"
#include "io/picture_file.h"
#include "plugin_api/text_file.h"
#include "report/calibration_plots.h"

namespace alidade {

namespace {

constexpr CalibrationPlot kPlots[] = {CalibrationPlot::Residuals, CalibrationPlot::Radial, CalibrationPlot::Coverage};

std::string textOf(const CalibrationReport& report) {
  std::string text = fmt::format("Board {}, {}\n\n{}", report.board, report.software, report.summary.report());
  if (!report.leftOut.empty()) text += "\nLeft out\n";
  for (const std::string& line : report.leftOut) text += "  " + line + "\n";
  return text;
}

/// The page on an area of the proportions of A4.
void paintPage(QPainter& painter, const QRectF& page, const CalibrationReport& report) {
  const double unit = page.width() / 100, margin = 5 * unit;
  painter.fillRect(page, Qt::white);
  painter.setPen(QColor(20, 22, 25));
  QFont heading(QStringLiteral("DejaVu Sans"));
  heading.setPixelSize(static_cast<int>(2.2 * unit));
  heading.setBold(true);
  painter.setFont(heading);
  painter.drawText(QRectF(margin, margin, page.width() - 2 * margin, 3 * unit), Qt::AlignLeft | Qt::AlignVCenter,
                   QString::fromStdString(report.title));
  const double half = (page.width() - 2 * margin - 2 * unit) / 2;
  const double plotsTop = page.height() - margin - 2 * 0.72 * half - 2 * unit;
  // As large as its longest line and their number allow.
  const QString text = QString::fromStdString(textOf(report));
  const QRectF room(margin, margin + 4 * unit, page.width() - 2 * margin, plotsTop - margin - 5 * unit);
  QFont body(QStringLiteral("DejaVu Sans Mono"));
  for (double size = 1.3; size > 0.5; size *= 0.93) {
    body.setPixelSize(std::max(1, static_cast<int>(size * unit)));
    painter.setFont(body);
    if (painter.boundingRect(room, Qt::AlignLeft | Qt::AlignTop | Qt::TextWordWrap, text).height() <= room.height()) break;
  }
  painter.save();
  painter.setClipRect(room);
  painter.drawText(room, Qt::AlignLeft | Qt::AlignTop | Qt::TextWordWrap, text);
  painter.restore();
  if (!report.summary.converged) return;
  for (int i = 0; i < 3; ++i)
    paintCalibrationPlot(painter, QRectF(margin + i % 2 * (half + 2 * unit), plotsTop + i / 2 * (0.72 * half + 2 * unit), half, 0.72 * half),
                         kPlots[i], report.summary, PlotGround::Paper);
}

QByteArray pdfOf(const CalibrationReport& report) {
  QByteArray bytes;
  QBuffer buffer(&bytes);
  buffer.open(QIODevice::WriteOnly);
  {
    QPdfWriter writer(&buffer);
    writer.setPageSize(QPageSize(QPageSize::A4));
    writer.setPageMargins(QMarginsF(0, 0, 0, 0));
    writer.setResolution(300);
    writer.setTitle(QString::fromStdString(report.title));
    writer.setCreator(QString::fromStdString(report.software));
    QPainter painter(&writer);
    paintPage(painter, QRectF(0, 0, writer.width(), writer.height()), report);
  }
  return bytes;
}

std::string htmlOf(const CalibrationReport& report) {
  const auto escaped = [](const std::string& text) { return QString::fromStdString(text).toHtmlEscaped().toStdString(); };
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>\n<style>body{{font-family:sans-serif;"
      "margin:2em;max-width:80em}}pre{{font-family:monospace}}img{{max-width:100%;border:1px solid #ccc;margin:0 1em 1em 0}}</style></head>\n"
      "<body><h1>{0}</h1>\n<pre>{1}</pre>\n", escaped(report.title), escaped(textOf(report)));
  if (report.summary.converged)
    for (const CalibrationPlot plot : kPlots) {
      const ColourImage image = calibrationPicture(plot, report.summary, 900, 650, PlotGround::Paper);
      const QImage view(reinterpret_cast<const uchar*>(image.data()), image.width(), image.height(), image.width() * 4, QImage::Format_RGBA8888);
      QByteArray png;
      QBuffer buffer(&png);
      buffer.open(QIODevice::WriteOnly);
      view.save(&buffer, "PNG");
      page += fmt::format("<img src=\"data:image/png;base64,{}\">\n", png.toBase64().toStdString());
    }
  return page + "</body></html>\n";
}

Result<void> write(std::string_view bytes, const std::string& path) {
  auto file = AtomicFile::create(path);
  if (!file) return fail(file.error());
  file->write(std::as_bytes(std::span(bytes)));
  return file->commit();
}

}  // namespace

Result<void> writeCalibrationReport(const CalibrationReport& report, const std::string& path) {
  const std::string ending = lowerCase(std::filesystem::path(path).extension().string());
  if (ending == ".html" || ending == ".htm") return write(htmlOf(report), path);
  if (ending == ".pdf") {
    const QByteArray bytes = pdfOf(report);
    return write({bytes.constData(), static_cast<std::size_t>(bytes.size())}, path);
  }
  if (ending != ".png")
    return fail(fmt::format("A report is not written as '{}'", ending), path, "Give a name that ends in .pdf, .html or .png");
  ColourImage page(1654, 2339);  // A4 at 200 dots an inch
  QImage canvas(reinterpret_cast<uchar*>(page.data()), page.width(), page.height(), page.width() * 4, QImage::Format_RGBA8888);
  QPainter painter(&canvas);
  paintPage(painter, QRectF(0, 0, page.width(), page.height()), report);
  painter.end();
  return writePng(page, path, {{"Software", report.software}, {"Title", report.title}});
}

}  // namespace alidade
