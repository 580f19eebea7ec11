// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <chrono>

#include "las/byte_source.h"

namespace alidade {

struct HttpOptions {
  std::chrono::seconds connectTimeout{10};
  std::chrono::seconds stallTimeout{30};  ///< without a byte
};

/// A file on an HTTP server, read by ranges (RFC 9110, 14). Small reads are answered from blocks of 64 KiB that are
/// kept, so that header, records and hierarchy take few requests; a read of more takes one request. Error where the server
/// has no such file, knows no ranges or does not answer.
Result<std::shared_ptr<const ByteSource>> openHttpSource(const std::string& address, const HttpOptions& options = {});

}  // namespace alidade
