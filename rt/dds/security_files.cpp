// SPDX-License-Identifier: BSD-3-Clause
#include "rt/dds/security_files.h"

#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <memory>
#include <type_traits>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

// Without it, OpenSSL would ask for the password of a key on the terminal.
int no_password(char*, int, int, void*) { return -1; }

// What `read`, one of OpenSSL's PEM_read_bio_..., makes of a file.
template <auto read, auto release>
auto read_pem(const std::string& path, const char* expected) {
  const std::unique_ptr<BIO, decltype(&BIO_free)> file(BIO_new_file(path.c_str(), "r"), BIO_free);
  auto* const found = file ? read(file.get(), nullptr, no_password, nullptr) : nullptr;
  ERR_clear_error();
  if (!found) {
    throw InputError(fmt::format("DDS security: {}: expected {} in PEM format", path, expected));
  }
  return std::unique_ptr<std::remove_pointer_t<decltype(found)>, decltype(release)>(found, release);
}

}  // namespace

void check_key(const std::string& certificate_path, const std::string& key_path) {
  const auto certificate =
      read_pem<PEM_read_bio_X509, &X509_free>(certificate_path, "a certificate");
  const auto key = read_pem<PEM_read_bio_PrivateKey, &EVP_PKEY_free>(
      key_path, "a private key without a password");
  if (X509_check_private_key(certificate.get(), key.get()) == 1) return;
  ERR_clear_error();
  throw InputError(fmt::format("DDS security: {}: found a key that does not belong to {}", key_path,
                               certificate_path));
}

}  // namespace sandrunner
