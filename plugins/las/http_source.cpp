// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/http_source.h"

#include <algorithm>
#include <cstring>
#include <list>
#include <mutex>
#include <vector>

#include <curl/curl.h>
#include <fmt/format.h>

namespace alidade {

namespace {

constexpr std::uint64_t kBlock = 64 << 10;
constexpr std::size_t kMostBlocks = 64;

/// What one request brought.
struct Answer {
  std::span<std::byte> into;
  std::size_t received = 0;
  bool tooMuch = false;
  std::uint64_t total = 0;  ///< of the whole file, from Content-Range
};

std::size_t takeBody(char* data, std::size_t, std::size_t size, void* user) {
  auto& answer = *static_cast<Answer*>(user);
  if (size > answer.into.size() - answer.received) {
    answer.tooMuch = true;  // a server that sends all of it instead
    return 0;
  }
  std::memcpy(answer.into.data() + answer.received, data, size);
  answer.received += size;
  return size;
}

std::size_t takeHeader(char* data, std::size_t, std::size_t size, void* user) {
  auto& answer = *static_cast<Answer*>(user);
  std::string line(data, size);
  std::transform(line.begin(), line.end(), line.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; });
  // content-range: bytes 0-65535/1234567
  if (line.starts_with("content-range:"))
    if (const auto slash = line.find('/'); slash != std::string::npos)
      answer.total = std::strtoull(line.c_str() + slash + 1, nullptr, 10);
  return size;
}

/// A connection that is kept for the next request.
class Connection {
 public:
  Connection() {
    static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
    if (ready == CURLE_OK) m_handle = curl_easy_init();
  }
  ~Connection() {
    if (m_handle) curl_easy_cleanup(m_handle);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  Result<Answer> get(const std::string& address, std::uint64_t offset, std::span<std::byte> into,
                     const HttpOptions& options) {
    if (!m_handle) return fail("The library for web addresses cannot be started", address, "Copy the file to this machine");
    Answer answer;
    answer.into = into;
    const std::string range = fmt::format("{}-{}", offset, offset + into.size() - 1);
    curl_easy_setopt(m_handle, CURLOPT_URL, address.c_str());
    curl_easy_setopt(m_handle, CURLOPT_RANGE, range.c_str());
    curl_easy_setopt(m_handle, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(m_handle, CURLOPT_REDIR_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(m_handle, CURLOPT_FOLLOWLOCATION, 1L);
    curl_easy_setopt(m_handle, CURLOPT_MAXREDIRS, 5L);
    curl_easy_setopt(m_handle, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(m_handle, CURLOPT_FAILONERROR, 0L);
    curl_easy_setopt(m_handle, CURLOPT_CONNECTTIMEOUT, static_cast<long>(options.connectTimeout.count()));
    curl_easy_setopt(m_handle, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(m_handle, CURLOPT_LOW_SPEED_TIME, static_cast<long>(options.stallTimeout.count()));
    curl_easy_setopt(m_handle, CURLOPT_WRITEFUNCTION, takeBody);
    curl_easy_setopt(m_handle, CURLOPT_WRITEDATA, &answer);
    curl_easy_setopt(m_handle, CURLOPT_HEADERFUNCTION, takeHeader);
    curl_easy_setopt(m_handle, CURLOPT_HEADERDATA, &answer);
    const CURLcode code = curl_easy_perform(m_handle);
    long status = 0;
    curl_easy_getinfo(m_handle, CURLINFO_RESPONSE_CODE, &status);
    if (status == 404 || status == 410)
      return fail("The server has no such file", address, "Check the address");
    if (status == 401 || status == 403)
      return fail(fmt::format("The server does not give this file to everybody (status {})", status), address,
                  "Ask its owner for access, or copy the file to this machine");
    if (status == 200)
      return fail("The server does not hand out parts of files (no range requests)", address,
                  "Copy the file to this machine, or to a server that does");
    if (status != 0 && status != 206 && status != 416)
      return fail(fmt::format("The server answers with status {}", status), address, "Try again later, or check the address");
    if (code == CURLE_OPERATION_TIMEDOUT)
      return fail("The server does not answer in time", address, "Check the connection, and try again");
    if (code != CURLE_OK && !answer.tooMuch)
      return fail(fmt::format("The server cannot be read: {}", curl_easy_strerror(code)), address,
                  "Check the address and the connection");
    if (answer.tooMuch) return fail("The server sends more than it was asked for", address, "Copy the file to this machine");
    return answer;
  }

 private:
  CURL* m_handle = nullptr;
};

class HttpSource : public ByteSource {
 public:
  HttpSource(const std::string& address, std::uint64_t size, std::vector<std::byte> head, const HttpOptions& options)
      : ByteSource(address, size), m_options(options) {
    m_blocks.push_front({0, std::move(head)});
  }

  Result<void> readAt(std::uint64_t offset, std::span<std::byte> into) const override {
    if (into.size() > size() || offset > size() - into.size())
      return fail(fmt::format("The file ends before byte {}", offset + into.size()), path(),
                  "The file is truncated or damaged: copy or export it again");
    while (!into.empty()) {
      const std::uint64_t block = offset / kBlock, within = offset % kBlock;
      std::size_t count = std::min<std::uint64_t>(into.size(), kBlock - within);
      if (into.size() >= kBlock && !isKept(block)) {
        // All that is left at once.
        return fetch(offset, into);
      }
      if (auto ok = copyFromBlock(block, within, into.first(count)); !ok) return ok;
      into = into.subspan(count);
      offset += count;
    }
    return {};
  }

 private:
  struct Block {
    std::uint64_t index;
    std::vector<std::byte> bytes;
  };

  bool isKept(std::uint64_t index) const {
    std::lock_guard lock(m_mutex);
    return std::any_of(m_blocks.begin(), m_blocks.end(), [&](const Block& each) { return each.index == index; });
  }

  Result<void> copyFromBlock(std::uint64_t index, std::uint64_t within, std::span<std::byte> into) const {
    {
      std::lock_guard lock(m_mutex);
      const auto found = std::find_if(m_blocks.begin(), m_blocks.end(), [&](const Block& each) { return each.index == index; });
      if (found != m_blocks.end()) {
        std::memcpy(into.data(), found->bytes.data() + within, into.size());
        m_blocks.splice(m_blocks.begin(), m_blocks, found);
        return {};
      }
    }
    Block block{index, std::vector<std::byte>(std::min(kBlock, size() - index * kBlock))};
    if (auto ok = fetch(index * kBlock, block.bytes); !ok) return ok;
    std::memcpy(into.data(), block.bytes.data() + within, into.size());
    std::lock_guard lock(m_mutex);
    m_blocks.push_front(std::move(block));
    if (m_blocks.size() > kMostBlocks) m_blocks.pop_back();
    return {};
  }

  Result<void> fetch(std::uint64_t offset, std::span<std::byte> into) const {
    std::unique_ptr<Connection> connection;
    {
      std::lock_guard lock(m_mutex);
      if (!m_connections.empty()) {
        connection = std::move(m_connections.back());
        m_connections.pop_back();
      }
    }
    if (!connection) connection = std::make_unique<Connection>();
    const auto answer = connection->get(path(), offset, into, m_options);
    if (!answer) return fail(answer.error());
    if (answer->received != into.size())
      return fail(fmt::format("The server sends {} bytes of {}", answer->received, into.size()), path(),
                  "The file may have changed meanwhile: open it again");
    std::lock_guard lock(m_mutex);
    m_connections.push_back(std::move(connection));
    return {};
  }

  HttpOptions m_options;
  mutable std::mutex m_mutex;
  mutable std::list<Block> m_blocks;  ///< the last used first
  mutable std::vector<std::unique_ptr<Connection>> m_connections;
};

}  // namespace

Result<std::shared_ptr<const ByteSource>> openHttpSource(const std::string& address, const HttpOptions& options) {
  std::vector<std::byte> head(kBlock);
  const auto answer = Connection().get(address, 0, head, options);
  if (!answer) return fail(answer.error());
  if (answer->received == 0 || answer->total == 0)
    return fail("The file is empty, or the server does not say how long it is", address, "Copy the file to this machine");
  if (answer->received < std::min<std::uint64_t>(kBlock, answer->total))
    return fail("The server sends less than it was asked for", address, "Try again, or copy the file to this machine");
  head.resize(answer->received);
  return std::make_shared<const HttpSource>(address, answer->total, std::move(head), options);
}

}  // namespace alidade
