// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QString>
#include <QStringList>

namespace alidade {

class MainWindow;

/// Waits until everything is loaded and rendered, runs the named commands one after the other (each
/// again until all is still), saves a picture of the window and leaves the program: 0, or 1 where it
/// could not be written or nothing came to rest within two minutes.
void takeScreenshot(MainWindow& window, const QString& path, const QStringList& commands);

}  // namespace alidade
