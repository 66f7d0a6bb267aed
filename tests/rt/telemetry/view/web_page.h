// SPDX-License-Identifier: BSD-3-Clause
// A page, and a visitor who is none, over real sockets.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace sandrunner {

/// A connection to the server; every wait ends after 10 s.
class Client {
 public:
  explicit Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const timeval patience{10, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~Client() { close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void send(std::string_view text) {
    while (!text.empty()) {
      const ssize_t sent = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
      if (sent <= 0) return;
      text.remove_prefix(static_cast<std::size_t>(sent));
    }
  }
  /// All until the server closes; nothing if it does not.
  std::optional<std::string> rest() {
    while (more()) {
    }
    if (!closed_) return std::nullopt;
    return std::exchange(got_, {});
  }
  std::string until(std::string_view end) {
    while (got_.find(end) == std::string::npos && more()) {
    }
    const std::size_t at = got_.find(end);
    return at == std::string::npos ? std::string() : take(at + end.size());
  }
  std::string bytes(std::size_t count) {
    while (got_.size() < count && more()) {
    }
    return got_.size() < count ? std::string() : take(count);
  }

 private:
  bool more() {
    char buffer[65536];
    const ssize_t count = recv(socket_, buffer, sizeof buffer, 0);
    if (count > 0) got_.append(buffer, static_cast<std::size_t>(count));
    closed_ = count == 0 || (count < 0 && errno == ECONNRESET);
    return count > 0;
  }
  std::string take(std::size_t count) {
    std::string taken = got_.substr(0, count);
    got_.erase(0, count);
    return taken;
  }

  int socket_;
  std::string got_;
  bool closed_ = false;
};

struct Message {
  int kind = -1;  ///< opcode: 1 text, 2 binary, 8 close; -1: the connection ended
  std::string text;
};

/// A live connection: of a page that has been let in.
class WebPage : public Client {
 public:
  explicit WebPage(int port)
      : WebPage(port, "/live", "Origin: http://127.0.0.1:" + std::to_string(port) + "\r\n") {}
  /// `lines`: of the request's header.
  WebPage(int port, const std::string& target, const std::string& lines) : Client(port) {
    send("GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\n" + lines +
         "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    answer = until("\r\n\r\n");
  }
  void say(std::string_view text, int kind = 1) {
    std::string frame(1, static_cast<char>(0x80 | kind));
    if (text.size() < 126) {
      frame += static_cast<char>(0x80 | text.size());
    } else {
      frame += static_cast<char>(0x80 | 126);
      frame += static_cast<char>(text.size() >> 8);
      frame += static_cast<char>(text.size());
    }
    frame += std::string(4, '\0');  // a mask that changes nothing
    send(frame.append(text));
  }
  Message hear() {
    const std::string head = bytes(2);
    if (head.empty()) return {};
    std::size_t size = head[1] & 0x7f;
    if (size >= 126) {
      const std::string length = bytes(size == 126 ? 2 : 8);
      size = 0;
      for (const char c : length) size = size << 8 | static_cast<unsigned char>(c);
    }
    return {head[0] & 0x0f, size == 0 ? std::string() : bytes(size)};
  }
  /// The next text that says this.
  nlohmann::json hear(const std::string& say) {
    for (Message m = hear(); m.kind != -1 && m.kind != 8; m = hear()) {
      if (m.kind != 1) continue;
      nlohmann::json json = nlohmann::json::parse(m.text);
      if (json.at("say") == say) return json;
    }
    ADD_FAILURE() << "never heard " << say;
    return {};
  }
  /// The code with which the server closes.
  int close_code() {
    for (Message m = hear(); m.kind != -1; m = hear()) {
      if (m.kind != 8 || m.text.size() < 2) continue;
      return static_cast<unsigned char>(m.text[0]) << 8 | static_cast<unsigned char>(m.text[1]);
    }
    return -1;
  }
  std::string answer;  ///< to the request
};

}  // namespace sandrunner
