// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>
#include <initializer_list>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include <QSqlQuery>
#include <QVariant>

#include "base/error.h"
#include "base/id.h"

namespace alidade {

/// Text that is not UTF-8 (a Linux file name may hold any bytes) becomes a blob.
QVariant variantFromText(const std::string& text);

/// Takes columns and values of one row from `visit` (project_fields.h).
class RowWriter {
 public:
  void operator()(const char* column, double& value) { put(column, std::isnan(value) ? QVariant() : QVariant(value)); }
  void operator()(const char* column, std::string& value) { put(column, variantFromText(value)); }
  template <class Tag>
  void operator()(const char* column, Id<Tag>& id) { (*this)(column, id.value); }
  template <class T>
    requires std::is_integral_v<T>
  void operator()(const char* column, T& value) {
    put(column, QVariant(static_cast<qlonglong>(value)));
  }
  template <class E>
  void choice(const char* column, E& value, std::initializer_list<const char*> names) {
    const auto index = static_cast<std::size_t>(value);
    check(index < names.size(), column, "is out of range");
    put(column, index < names.size() ? QVariant(names.begin()[index]) : QVariant());
  }
  void check(bool fine, const char* column, const std::string& what) {
    if (!fine && m_problem.empty()) m_problem = std::string(column) + " " + what;
  }

  const std::vector<const char*>& columns() const { return m_columns; }
  const std::vector<QVariant>& values() const { return m_values; }
  const std::string& problem() const { return m_problem; }

 private:
  void put(const char* column, QVariant value) {
    m_columns.push_back(column);
    m_values.push_back(std::move(value));
  }

  std::vector<const char*> m_columns;
  std::vector<QVariant> m_values;
  std::string m_problem;
};

/// Gives the current row of a query to `visit`, column by column in the same order. Stops at the
/// first value that is not what the column holds: SQLite lets any value stand anywhere.
/// Columns that `absent` marks are of a later version than the file: their members keep their defaults.
class RowReader {
 public:
  RowReader(const QSqlQuery& query, const std::vector<bool>& absent) : m_query(query), m_absent(absent) {}

  void operator()(const char* column, double& value);
  void operator()(const char* column, std::string& value);
  void operator()(const char* column, bool& value);
  template <class Tag>
  void operator()(const char* column, Id<Tag>& id) { (*this)(column, id.value); }
  template <class T>
    requires std::is_integral_v<T>
  void operator()(const char* column, T& value) {
    if (skipsAbsent()) return;
    const std::int64_t stored = integer(column);
    // 64-bit sizes are stored by their bits, SQLite has no unsigned integers.
    if constexpr (sizeof(T) < 8)
      check(stored >= static_cast<std::int64_t>(std::numeric_limits<T>::min()) &&
                stored <= static_cast<std::int64_t>(std::numeric_limits<T>::max()),
            column, "is out of range");
    value = static_cast<T>(stored);
  }
  template <class E>
  void choice(const char* column, E& value, std::initializer_list<const char*> names) {
    if (skipsAbsent()) return;
    std::string name;
    (*this)(column, name);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (name != names.begin()[i]) continue;
      value = static_cast<E>(i);
      return;
    }
    check(false, column, "holds a word that this version does not know");
  }
  void check(bool fine, const char* column, const std::string& what) {
    if (!fine && m_problem.empty()) m_problem = std::string(column) + " " + what;
  }

  const std::string& problem() const { return m_problem; }

 private:
  std::int64_t integer(const char* column);
  bool skipsAbsent() {
    if (!m_absent[static_cast<std::size_t>(m_index)]) return false;
    ++m_index;
    return true;
  }

  const QSqlQuery& m_query;
  const std::vector<bool>& m_absent;
  int m_index = 0;
  std::string m_problem;
};

}  // namespace alidade
