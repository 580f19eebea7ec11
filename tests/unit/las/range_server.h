// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

namespace alidade::testing {

/// A web server for one file on this machine's own address, a request a connection. Knows GET with one range.
class RangeServer {
 public:
  enum class Manner { Ranges, WholeOnly, Missing, Silent };

  RangeServer(std::vector<std::uint8_t> content, Manner manner) : m_content(std::move(content)), m_manner(manner) {
    m_listener = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (::bind(m_listener, reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(m_listener, 16) != 0) std::abort();
    ::getsockname(m_listener, reinterpret_cast<sockaddr*>(&address), &size);
    m_port = ntohs(address.sin_port);
    m_thread = std::thread([this] { serve(); });
  }
  ~RangeServer() {
    m_stop = true;
    ::shutdown(m_listener, SHUT_RDWR);
    ::close(m_listener);
    m_thread.join();
  }

  std::string address(const std::string& name) const { return "http://127.0.0.1:" + std::to_string(m_port) + "/" + name; }
  int requests() const { return m_requests; }
  std::size_t bytesSent() const { return m_sent; }

 private:
  void serve() {
    while (!m_stop) {
      const int connection = ::accept(m_listener, nullptr, nullptr);
      if (connection < 0) return;
      answer(connection);
      ::close(connection);
    }
  }

  void answer(int connection) {
    std::string request;
    char buffer[4096];
    while (request.find("\r\n\r\n") == std::string::npos) {
      const ssize_t count = ::recv(connection, buffer, sizeof buffer, 0);
      if (count <= 0) return;
      request.append(buffer, static_cast<std::size_t>(count));
    }
    ++m_requests;
    if (m_manner == Manner::Silent) {
      while (!m_stop && ::recv(connection, buffer, sizeof buffer, 0) > 0) {
      }
      return;
    }
    if (m_manner == Manner::Missing) return send(connection, "HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n", 0, 0);
    unsigned long first = 0, last = m_content.size() - 1;
    const auto range = request.find("Range: bytes=");
    if (m_manner == Manner::WholeOnly || range == std::string::npos) {
      return send(connection, "HTTP/1.1 200 OK\r\nContent-Length: " + std::to_string(m_content.size()) + "\r\n", 0,
                  m_content.size());
    }
    std::sscanf(request.c_str() + range, "Range: bytes=%lu-%lu", &first, &last);
    last = std::min<unsigned long>(last, m_content.size() - 1);
    send(connection, "HTTP/1.1 206 Partial Content\r\nContent-Range: bytes " + std::to_string(first) + "-" +
                         std::to_string(last) + "/" + std::to_string(m_content.size()) +
                         "\r\nContent-Length: " + std::to_string(last - first + 1) + "\r\n",
         first, last - first + 1);
  }

  void send(int connection, const std::string& head, std::size_t first, std::size_t count) {
    std::string all = head + "Connection: close\r\n\r\n";
    all.append(reinterpret_cast<const char*>(m_content.data()) + first, count);
    m_sent += count;
    for (std::size_t done = 0; done < all.size();) {
      const ssize_t sent = ::send(connection, all.data() + done, all.size() - done, MSG_NOSIGNAL);
      if (sent <= 0) return;
      done += static_cast<std::size_t>(sent);
    }
  }

  std::vector<std::uint8_t> m_content;
  Manner m_manner;
  int m_listener = -1;
  unsigned m_port = 0;
  std::atomic<bool> m_stop{false};
  std::atomic<int> m_requests{0};
  std::atomic<std::size_t> m_sent{0};
  std::thread m_thread;
};

}  // namespace alidade::testing
