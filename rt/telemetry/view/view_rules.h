// SPDX-License-Identifier: BSD-3-Clause
// Who may look and who may touch: everything that the server decides about a request, without a
// socket.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

namespace sandrunner {

inline constexpr std::size_t kViewHeaderBytes = 8192;   ///< of a request, at most
inline constexpr std::size_t kViewMessageBytes = 4096;  ///< of a message of a page, at most
inline constexpr int kViewMessagesPerSecond = 200;      ///< of a page, at most
inline constexpr int kViewSockets = 32;                 ///< at one time
inline constexpr int kViewPages = 8;                    ///< and sessions of Foxglove, at one time
inline constexpr std::chrono::seconds kViewHeaderTime{5};

/// Headers of every answer: nothing but this server's own files is loaded or run, nobody else may
/// frame or embed the page.
inline constexpr std::array<std::array<std::string_view, 2>, 6> kViewHeaders = {{
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
     "img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cache-Control", "no-store"},
}};

/// What a request's header says.
struct ViewRequest {
  std::string_view method, target, host, origin = {};
  bool websocket = false;           ///< asks for an upgrade
  std::string_view protocols = {};  ///< that it offers to speak then
  bool topics = false;              ///< this server has topics for Foxglove
};

/// The answer to a request.
struct ViewVerdict {
  int status = 0;                ///< of HTTP; 101: a live connection
  std::string_view reason = {};  ///< for the client that was refused
  std::string_view file = {};    ///< status 200: embedded file to send
  std::string_view type = {};    ///< of its content
  /// Status 101: empty for a page, or the name of Foxglove's protocol to answer with.
  std::string_view protocol = {};
};

/// Host is this computer under any port (tunnels end on others), or a page that was loaded from
/// another name could read along (DNS rebinding); GET of three names. A page's live connection
/// comes from this server's own page. Foxglove's, which only shows, comes from a program of this
/// computer (no origin, or that of a file), from a page of this computer, or from Foxglove's own.
ViewVerdict judge(const ViewRequest& request) noexcept;

/// 128 random bits as 32 hexadecimal digits.
std::string make_view_key();

/// In a time that does not depend on where they differ.
bool same_key(std::string_view a, std::string_view b) noexcept;

/// Counts the messages of a page.
class MessageRate {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// False: more than kViewMessagesPerSecond have come within a second.
  bool allows(Time now) noexcept;

 private:
  Time second_{};
  int count_ = 0;
};

}  // namespace sandrunner
