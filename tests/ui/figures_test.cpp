// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include <gtest/gtest.h>

#include <QLineEdit>
#include <QTest>

#include "ui/figure_spin.h"
#include "ui/format.h"

namespace alidade::test {

TEST(Figures, HaveATrueMinusAndNoNegativeNothing) {
  EXPECT_EQ(formatNumber(-0.254, 2), QStringLiteral("−0.25"));
  EXPECT_EQ(formatNumber(-0.004, 2), QStringLiteral("0.00"));
  EXPECT_EQ(formatNumber(12, 0), QStringLiteral("12"));
  EXPECT_EQ(formatNumber(std::nan(""), 2), QStringLiteral("–"));
  EXPECT_EQ(reportText("offset -0.25 s of GX-5-3: (-1, 2e-3)"), QStringLiteral("offset −0.25 s of GX-5-3: (−1, 2e-3)"));
}

TEST(Figures, AFieldShowsATrueMinusAndTakesEither) {
  FigureSpin spin;
  spin.setRange(-10, 10);
  spin.setDecimals(2);
  spin.setSuffix(" m");
  spin.setValue(-1.5);
  EXPECT_EQ(spin.text(), QStringLiteral("−1.50 m"));
  for (const QString& typed : {QStringLiteral("-2.25"), QStringLiteral("−2.25")}) {
    spin.setValue(1);
    auto* edit = spin.findChild<QLineEdit*>();
    edit->setText(typed);
    spin.interpretText();
    EXPECT_DOUBLE_EQ(spin.value(), -2.25) << typed.toStdString();
    EXPECT_EQ(spin.text(), QStringLiteral("−2.25 m"));
  }
  auto* edit = spin.findChild<QLineEdit*>();
  edit->clear();
  QTest::keyClicks(edit, "-3.5");
  spin.interpretText();
  EXPECT_DOUBLE_EQ(spin.value(), -3.5);
}

}  // namespace alidade::test
