// SPDX-License-Identifier: BSD-3-Clause
// The only file that includes Boost.
#include "rt/telemetry/view/view_server.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "rt/base/errors.h"
#include "rt/telemetry/view/embedded.h"
#include "rt/telemetry/view/view_orders.h"
#include "rt/telemetry/view/view_rules.h"

namespace sandrunner {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using Error = beast::error_code;
using Steady = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kSendEvery{16};
constexpr int kStateEvery = 6;  // of these: 10 times a second, so that silence means something
constexpr int kSendBuffer = 64 << 10;    // the kernel hoards no more for a page that does not read
constexpr std::size_t kMostAnswers = 4;  // waiting for a page; then it is not listened to
constexpr std::chrono::seconds kHandshakeTime{5}, kIdleTime{60};

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

class Page;

// A connection that another client may need the place of: a request that is not answered, or a page
// that has not said hello.
class Guest {
 public:
  virtual ~Guest() = default;
  // Gives its place to another client.
  virtual void leave() = 0;
};

// What all connections share; used by the server's thread alone. Lists are in the order in which
// they came.
struct Hub {
  ViewServer::Parts parts;
  std::string key, run;
  int sockets = 0;
  std::uint64_t pages_so_far = 0;
  std::vector<Page*> pages;  // that have said hello
  std::vector<Guest*> guests;
};

// One of the sockets that a server may have.
class Place {
 public:
  explicit Place(Hub& hub) : hub_(&hub) { ++hub.sockets; }
  Place(Place&& other) noexcept : hub_(std::exchange(other.hub_, nullptr)) {}
  ~Place() {
    if (hub_) --hub_->sockets;
  }

 private:
  Hub* hub_;
};

// A page that is open somewhere. One message is being written; what comes next is asked of the
// feed when that is done.
class Page : public Guest, public std::enable_shared_from_this<Page> {
 public:
  Page(Hub& hub, beast::tcp_stream stream, Place place)
      : hub_(hub), place_(std::move(place)), socket_(std::move(stream)) {
    hub_.guests.push_back(this);
  }
  ~Page() override { forget(); }
  Page(const Page&) = delete;
  Page& operator=(const Page&) = delete;

  bool has_key() const noexcept { return has_key_; }
  // At once: one that does not read its end would keep the place.
  void leave() override {
    closing_ = true;
    forget();
    place_.reset();
    beast::get_lowest_layer(socket_).close();
  }

  void begin(const http::request<http::empty_body>& request) {
    socket_.set_option(websocket::stream_base::timeout{kHandshakeTime, kIdleTime, true});
    socket_.read_message_max(kViewMessageBytes);
    socket_.auto_fragment(false);
    socket_.async_accept(request, [self = shared_from_this()](Error error) {
      if (!error) self->read();
    });
  }

  // Writes what there is, if nothing is being written. `state`: empty, or what is due.
  void send(const std::string& state = {}) {
    if (!state.empty()) state_ = state;
    if (!greeted_ || !message_.empty() || closing_) return;
    if (!answers_.empty()) {
      message_ = std::move(answers_.front());
      answers_.pop_front();
      socket_.text(true);
    } else if (message_ = hub_.parts.feed.next(in_feed_); !message_.empty()) {
      socket_.binary(true);
    } else if (!state_.empty()) {
      message_ = std::exchange(state_, {});
      socket_.text(true);
    } else {
      return;
    }
    socket_.async_write(asio::buffer(message_), [self = shared_from_this()](Error error, auto) {
      self->message_.clear();
      if (error) return;
      self->read();
      self->send();
    });
  }

 private:
  void read() {
    if (reading_ || closing_ || answers_.size() >= kMostAnswers) return;
    reading_ = true;
    socket_.async_read(buffer_, [self = shared_from_this()](Error error, auto) {
      self->reading_ = false;
      if (!error) self->take();
    });
  }

  void take() {
    if (!socket_.got_text()) return close(websocket::close_code::unknown_data, "expected text");
    if (!rate_.allows(Steady::now())) {
      return close(websocket::close_code::policy_error, "too many messages");
    }
    const PageMessage message = parse_page_message(
        {static_cast<const char*>(buffer_.data().data()), buffer_.data().size()});
    buffer_.consume(buffer_.size());
    if (const auto* hello = std::get_if<PageHello>(&message); hello && !greeted_) {
      has_key_ = same_key(hello->key, hub_.key);
      if (!take_place()) return close(websocket::close_code::try_again_later, "too many pages");
      greet(*hello);
    } else if (!greeted_) {
      return close(websocket::close_code::policy_error, "expected hello first");
    } else {
      follow(message);
    }
    send();
    read();
  }

  void follow(const PageMessage& message) {
    ViewOrders::Outcome outcome = orders_.follow(message, has_key_);
    if (!outcome.answer.empty()) answers_.push_back(std::move(outcome.answer));
    if (outcome.changed) state_ = view_state(hub_.parts);
  }

  // One of the places of pages. Who has the key gets that of the oldest page without.
  bool take_place() {
    if (hub_.pages.size() >= kViewPages) {
      const auto stranger =
          std::ranges::find_if(hub_.pages, [](const Page* page) { return !page->has_key(); });
      if (!has_key_ || stranger == hub_.pages.end()) return false;
      (*stranger)->leave();
    }
    std::erase(hub_.guests, static_cast<Guest*>(this));
    hub_.pages.push_back(this);
    return true;
  }

  void greet(const PageHello& hello) {
    greeted_ = true;
    in_feed_ = hub_.parts.feed.join();
    answers_.push_back(fmt::format(
        R"({{"say":"hello","run":"{}","key":{},"pace":{},"drive":{},"recorded":{},"hello":{}}})",
        hub_.run, has_key_, hub_.parts.pace != nullptr, hub_.parts.desk != nullptr,
        hub_.parts.recorded, hub_.parts.feed.hello()));
    if (!hello.key.empty() && !has_key_) {
      answers_.push_back(view_refusal("the key is not this run's"));
    }
    send(view_state(hub_.parts));
  }

  void forget() {
    std::erase(hub_.pages, this);
    std::erase(hub_.guests, static_cast<Guest*>(this));
  }

  void close(websocket::close_code code, const char* why) {
    closing_ = true;
    socket_.async_close({code, why}, [self = shared_from_this()](Error) {});
  }

  Hub& hub_;
  std::optional<Place> place_;
  ViewOrders orders_{hub_.parts, ++hub_.pages_so_far};
  websocket::stream<beast::tcp_stream, false> socket_;  // without compression, which is never asked
  beast::flat_buffer buffer_{2 * kViewMessageBytes};
  MessageRate rate_;
  ViewFeed::Place in_feed_;
  bool greeted_ = false, has_key_ = false, reading_ = false, closing_ = false;
  std::deque<std::string> answers_;
  std::string state_, message_;  // the latter: being written
};

// A request, until it is answered or a page.
class Visitor : public Guest, public std::enable_shared_from_this<Visitor> {
 public:
  Visitor(Hub& hub, Tcp::socket socket)
      : hub_(hub), place_(hub), stream_(std::move(socket)), parser_(std::in_place) {
    hub_.guests.push_back(this);
  }
  ~Visitor() override { std::erase(hub_.guests, static_cast<Guest*>(this)); }
  Visitor(const Visitor&) = delete;
  Visitor& operator=(const Visitor&) = delete;

  void leave() override {
    std::erase(hub_.guests, static_cast<Guest*>(this));
    place_.reset();
    stream_.close();
  }

  void begin() {
    parser_->header_limit(kViewHeaderBytes);
    stream_.expires_after(kViewHeaderTime);
    http::async_read_header(stream_, buffer_, *parser_,
                            [self = shared_from_this()](Error error, auto) {
                              if (!error && self->place_) self->answer();
                            });
  }

 private:
  void answer() {
    const auto& request = parser_->get();
    const std::string method(request.method_string());
    const ViewVerdict verdict = judge({.method = method,
                                       .target = view_of(request.target()),
                                       .host = view_of(request[http::field::host]),
                                       .origin = view_of(request[http::field::origin]),
                                       .websocket = websocket::is_upgrade(request)});
    if (verdict.status == 101) {
      stream_.expires_never();
      std::make_shared<Page>(hub_, std::move(stream_), std::move(*place_))->begin(request);
      return;
    }
    response_.version(11);
    response_.result(static_cast<unsigned>(verdict.status));
    for (const auto& [name, value] : kViewHeaders) {
      response_.set(beast::string_view(name.data(), name.size()),
                    beast::string_view(value.data(), value.size()));
    }
    const std::string_view type = verdict.status == 200 ? verdict.type : "text/plain";
    response_.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    if (verdict.file.ends_with(".gz")) response_.set(http::field::content_encoding, "gzip");
    if (verdict.status == 405) response_.set(http::field::allow, "GET");
    response_.body() = verdict.status == 200 ? embedded_page_file(verdict.file) : verdict.reason;
    response_.keep_alive(false);
    response_.prepare_payload();
    http::async_write(stream_, response_, [self = shared_from_this()](Error, auto) {
      Error ignored;
      self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    });
  }

  Hub& hub_;
  std::optional<Place> place_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kViewHeaderBytes + 1024};
  std::optional<http::request_parser<http::empty_body>> parser_;
  http::response<http::string_body> response_;
};

}  // namespace

class ViewServer::Implementation {
 public:
  Implementation(int port, const Parts& parts)
      : hub_{.parts = parts,
             .key = make_view_key(),
             .run = make_view_key(),
             .pages = {},
             .guests = {}},
        io_(1),
        timer_(io_) {
    listen(asio::ip::address_v4::loopback(), port);
    port_ = acceptors_.front().local_endpoint().port();
    listen(asio::ip::address_v6::loopback(), port_);
    for (Tcp::acceptor& acceptor : acceptors_) accept(acceptor);
    tick();
    thread_ = std::thread([this] {
      constexpr int kLow = 10;
      setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kLow);  // of this thread alone
      io_.run();
    });
    pthread_setname_np(thread_.native_handle(), "view-server");
  }
  ~Implementation() {
    io_.stop();
    thread_.join();
  }

  std::string url() const { return fmt::format("http://127.0.0.1:{}/#key={}", port_, hub_.key); }

 private:
  void listen(const asio::ip::address& address, int port) {
    const Tcp::endpoint end(address, static_cast<std::uint16_t>(port));
    Tcp::acceptor acceptor(io_);
    Error error;
    acceptor.open(end.protocol(), error);
    if (!error) acceptor.set_option(Tcp::acceptor::reuse_address(true), error);
    if (!error && address.is_v6()) acceptor.set_option(asio::ip::v6_only(true), error);
    if (!error) acceptor.bind(end, error);
    if (!error) acceptor.listen(kViewSockets, error);
    if (!error) {
      acceptors_.push_back(std::move(acceptor));
    } else if (error == asio::error::address_in_use || address.is_v4()) {
      throw InputError(fmt::format(
          "view.port: {} of {}: {}, expected a port that is free, as any is with --set view.port=0",
          port, address.to_string(), error.message()));
    }  // else this computer has no IPv6
  }

  void accept(Tcp::acceptor& acceptor) {
    acceptor.async_accept([this, &acceptor](Error error, Tcp::socket socket) {
      if (error) {  // no descriptor is left, for one: at once again, it would be the same
        refused_.push_back(&acceptor);
        return;
      }
      // A browser's request is there at once: the client that has kept the server waiting longest
      // goes.
      if (hub_.sockets >= kViewSockets && !hub_.guests.empty()) hub_.guests.front()->leave();
      if (hub_.sockets < kViewSockets) {
        Error ignored;
        socket.set_option(Tcp::no_delay(true), ignored);
        socket.set_option(Tcp::socket::send_buffer_size(kSendBuffer), ignored);
        std::make_shared<Visitor>(hub_, std::move(socket))->begin();
      }
      accept(acceptor);
    });
  }

  void tick() {
    timer_.expires_after(kSendEvery);
    timer_.async_wait([this](Error error) {
      if (error) return;
      const bool state = ++ticks_ % kStateEvery == 0 && !hub_.pages.empty();
      const std::string text = state ? view_state(hub_.parts) : std::string();
      for (Page* const page : std::vector(hub_.pages)) page->send(text);
      for (Tcp::acceptor* const acceptor : std::exchange(refused_, {})) accept(*acceptor);
      tick();
    });
  }

  Hub hub_;  // outlives what is in io_
  asio::io_context io_;
  std::vector<Tcp::acceptor> acceptors_;
  std::vector<Tcp::acceptor*> refused_;  // that accept again at the next tick
  asio::steady_timer timer_;
  std::uint64_t ticks_ = 0;
  int port_ = 0;
  std::thread thread_;
};

ViewServer::ViewServer(int port, const Parts& parts)
    : implementation_(std::make_unique<Implementation>(port, parts)) {}
ViewServer::~ViewServer() = default;

std::string ViewServer::url() const { return implementation_->url(); }

}  // namespace sandrunner
