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
#include "rt/telemetry/view/foxglove_session.h"
#include "rt/telemetry/view/page_session.h"
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
constexpr int kSendBuffer = 64 << 10;  // the kernel hoards no more for a page that does not read
constexpr std::chrono::seconds kHandshakeTime{5}, kIdleTime{60};

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

class Connection;

// A socket that another client may need the place of: a request that is not answered, or a page
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
  std::vector<Connection*> seated;  // pages that have said hello, and Foxglove
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

// A client that stays. One message is being written; what comes next is asked of its session when
// that is done.
class Connection : public Guest, public std::enable_shared_from_this<Connection> {
 public:
  Connection(Hub& hub, beast::tcp_stream stream, Place place, std::unique_ptr<ViewSession> session)
      : hub_(hub),
        place_(std::move(place)),
        session_(std::move(session)),
        socket_(std::move(stream)) {
    hub_.guests.push_back(this);
  }
  ~Connection() override { forget(); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  // At once: one that does not read its end would keep the place.
  void leave() override {
    closing_ = true;
    forget();
    place_.reset();
    beast::get_lowest_layer(socket_).close();
  }

  // `protocol`: to answer with; empty: none.
  void begin(const http::request<http::empty_body>& request, std::string_view protocol) {
    socket_.set_option(websocket::stream_base::timeout{kHandshakeTime, kIdleTime, true});
    if (!protocol.empty()) {
      socket_.set_option(
          websocket::stream_base::decorator([protocol](websocket::response_type& response) {
            response.set(http::field::sec_websocket_protocol,
                         beast::string_view(protocol.data(), protocol.size()));
          }));
    }
    socket_.read_message_max(kViewMessageBytes);
    socket_.auto_fragment(false);
    socket_.async_accept(request, [self = shared_from_this()](Error error) {
      if (!error) self->go_on();
    });
  }

  // Writes what there is, if nothing is being written.
  void send() {
    if (!seated_ || !message_.bytes.empty() || closing_) return;
    message_ = session_->next();
    if (message_.bytes.empty()) return;
    socket_.text(message_.text);
    socket_.async_write(asio::buffer(message_.bytes),
                        [self = shared_from_this()](Error error, auto) {
                          self->message_ = {};
                          if (!error) self->go_on();
                        });
  }

 private:
  void go_on() {
    if (!take_seat()) return close(websocket::close_code::try_again_later, "too many pages");
    send();
    read();
  }

  void read() {
    if (reading_ || closing_ || !session_->listens()) return;
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
    const auto goodbye =
        session_->take({static_cast<const char*>(buffer_.data().data()), buffer_.data().size()});
    buffer_.consume(buffer_.size());
    if (goodbye) return close(static_cast<websocket::close_code>(goodbye->code), goodbye->why);
    go_on();
  }

  // One of the seats, as soon as the session claims one. Who has the key gets that of the oldest
  // client without. False: none is left.
  bool take_seat() {
    const ViewSession::Claim claim = session_->claim();
    if (seated_ || claim == ViewSession::Claim::kNone) return true;
    if (hub_.seated.size() >= kViewPages) {
      const auto stranger =
          std::ranges::find(hub_.seated, ViewSession::Claim::kLooks,
                            [](const Connection* other) { return other->session_->claim(); });
      if (claim == ViewSession::Claim::kLooks || stranger == hub_.seated.end()) return false;
      (*stranger)->leave();
    }
    std::erase(hub_.guests, static_cast<Guest*>(this));
    hub_.seated.push_back(this);
    seated_ = true;
    return true;
  }

  void forget() {
    std::erase(hub_.seated, this);
    std::erase(hub_.guests, static_cast<Guest*>(this));
  }

  void close(websocket::close_code code, const char* why) {
    closing_ = true;
    socket_.async_close({code, why}, [self = shared_from_this()](Error) {});
  }

  Hub& hub_;
  std::optional<Place> place_;
  const std::unique_ptr<ViewSession> session_;
  websocket::stream<beast::tcp_stream, false> socket_;  // without compression, which is never asked
  beast::flat_buffer buffer_{2 * kViewMessageBytes};
  MessageRate rate_;
  bool seated_ = false, reading_ = false, closing_ = false;
  ViewSession::Outgoing message_;  // being written
};

// A request, until it is answered or a connection that stays.
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
    const ViewVerdict verdict =
        judge({.method = method,
               .target = view_of(request.target()),
               .host = view_of(request[http::field::host]),
               .origin = view_of(request[http::field::origin]),
               .websocket = websocket::is_upgrade(request),
               .protocols = view_of(request[http::field::sec_websocket_protocol]),
               .topics = hub_.parts.topics != nullptr});
    if (verdict.status == 101) {
      stream_.expires_never();
      std::make_shared<Connection>(hub_, std::move(stream_), std::move(*place_),
                                   session_for(verdict))
          ->begin(request, verdict.protocol);
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

  std::unique_ptr<ViewSession> session_for(const ViewVerdict& verdict) {
    if (verdict.protocol.empty()) {
      return std::make_unique<PageSession>(hub_.parts, hub_.key, hub_.run, ++hub_.pages_so_far);
    }
    return std::make_unique<FoxgloveSession>(*hub_.parts.topics, hub_.run);
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
             .seated = {},
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
      for (Connection* const client : std::vector(hub_.seated)) client->send();
      for (Tcp::acceptor* const acceptor : std::exchange(refused_, {})) accept(*acceptor);
      tick();
    });
  }

  Hub hub_;  // outlives what is in io_
  asio::io_context io_;
  std::vector<Tcp::acceptor> acceptors_;
  std::vector<Tcp::acceptor*> refused_;  // that accept again at the next tick
  asio::steady_timer timer_;
  int port_ = 0;
  std::thread thread_;
};

ViewServer::ViewServer(int port, const Parts& parts)
    : implementation_(std::make_unique<Implementation>(port, parts)) {}
ViewServer::~ViewServer() = default;

std::string ViewServer::url() const { return implementation_->url(); }

}  // namespace sandrunner
