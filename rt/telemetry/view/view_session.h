// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace sandrunner {

/// One client of a live connection, without a socket: bytes in, bytes out.
class ViewSession {
 public:
  struct Outgoing {
    std::string bytes;  ///< empty: there is nothing to say now
    bool text = false;
  };
  struct Goodbye {
    std::uint16_t code;  ///< of a WebSocket's close
    const char* why;
  };
  /// What the client may claim a place for.
  enum class Claim { kNone, kLooks, kHasKey };

  virtual ~ViewSession() = default;
  /// The client said `text`, of kViewMessageBytes at most. If anything is returned, the connection
  /// is to be closed with it.
  virtual std::optional<Goodbye> take(std::string_view text) = 0;
  /// Asked whenever nothing is being written: answers first.
  Outgoing next() {
    if (answers_.empty()) return next_data();
    Outgoing answer{std::move(answers_.front()), true};
    answers_.pop_front();
    return answer;
  }
  virtual Claim claim() const = 0;
  /// False: kMostAnswers wait for the client, which is not listened to until it takes them.
  bool listens() const { return answers_.size() < kMostAnswers; }

 protected:
  static constexpr std::size_t kMostAnswers = 4;
  /// What is to be said where no answer waits.
  virtual Outgoing next_data() = 0;
  std::deque<std::string> answers_;
};

}  // namespace sandrunner
