//! The address at which a viewer listens.

use std::fmt::{self, Display};
use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::str::FromStr;
use std::time::Duration;

use re_sdk::external::re_uri::ProxyUri;
use thiserror::Error;

/// Address of a viewer, e.g. `rerun+http://127.0.0.1:9876/proxy`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Address(ProxyUri);

/// Why a text is not the address of a viewer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{cause}")]
pub struct AddressError {
    cause: String,
}

impl Address {
    /// The default address of a viewer.
    pub const DEFAULT: &str = "rerun+http://127.0.0.1:9876/proxy";

    /// Checks that a viewer listens there.
    ///
    /// # Errors
    /// No connection within `patience`.
    pub fn answers(&self, patience: Duration) -> io::Result<()> {
        let origin = &self.0.origin;
        let places = (origin.host.to_string(), origin.port).to_socket_addrs()?;
        let mut last = io::Error::from(io::ErrorKind::AddrNotAvailable);
        for place in places {
            match TcpStream::connect_timeout(&place, patience) {
                Ok(_) => return Ok(()),
                Err(error) => last = error,
            }
        }
        Err(last)
    }
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Address, AddressError> {
        text.parse()
            .map(Address)
            .map_err(|error: re_sdk::external::re_uri::Error| AddressError { cause: error.to_string() })
    }
}

impl Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_parsed_and_a_closed_port_is_an_error() {
        let address: Address = Address::DEFAULT.parse().unwrap();
        assert_eq!(address.to_string(), Address::DEFAULT);
        assert!("127.0.0.1".parse::<Address>().is_err());
        let closed: Address = "rerun+http://127.0.0.1:1/proxy".parse().unwrap();
        assert!(closed.answers(Duration::from_millis(500)).is_err());
    }
}
