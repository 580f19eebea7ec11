// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/project_rows.h"

#include <QByteArray>
#include <QMetaType>
#include <QString>

namespace alidade {

QVariant variantFromText(const std::string& text) {
  const QByteArray bytes(text.data(), static_cast<qsizetype>(text.size()));
  const QString words = QString::fromUtf8(bytes);
  if (words.toUtf8() == bytes && !words.contains(QChar(0))) return words.isNull() ? QVariant(QString("")) : QVariant(words);
  return bytes;
}

void RowReader::operator()(const char* column, double& value) {
  if (skipsAbsent()) return;
  const QVariant stored = m_query.value(m_index++);
  if (stored.isNull()) {
    value = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  const int type = stored.metaType().id();
  check(type == QMetaType::Double || type == QMetaType::LongLong, column, "is no number");
  value = stored.toDouble();
}

void RowReader::operator()(const char* column, std::string& value) {
  if (skipsAbsent()) return;
  const QVariant stored = m_query.value(m_index++);
  const int type = stored.metaType().id();
  check(!stored.isNull() && (type == QMetaType::QString || type == QMetaType::QByteArray), column, "is no text");
  const QByteArray bytes = type == QMetaType::QByteArray ? stored.toByteArray() : stored.toString().toUtf8();
  value.assign(bytes.constData(), static_cast<std::size_t>(bytes.size()));
}

void RowReader::operator()(const char* column, bool& value) {
  if (skipsAbsent()) return;
  const std::int64_t stored = integer(column);
  check(stored == 0 || stored == 1, column, "is neither 0 nor 1");
  value = stored == 1;
}

std::int64_t RowReader::integer(const char* column) {
  const QVariant stored = m_query.value(m_index++);
  check(!stored.isNull() && stored.metaType().id() == QMetaType::LongLong, column, "is no whole number");
  return stored.toLongLong();
}

}  // namespace alidade
