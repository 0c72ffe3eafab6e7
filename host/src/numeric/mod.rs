//! Small numerical tools that more than one part needs, each once.
//!
//! - [`order`]: median and quantiles; [`bisect`]: where something monotonous changes; [`top`]: the
//!   highest point of a smooth curve; [`simplex`]: the same in a few dimensions.
//! - [`mixture`]: weighted sums of parts; [`product`]: sums of products; [`taper`]: ends that rise smoothly; [`normal`]: figures of
//!   the normal law; [`turning`]: waves sample by sample; [`written`]: numbers for people.

pub mod bisect;
pub mod mixture;
pub mod normal;
pub mod order;
pub mod peak;
pub mod product;
pub mod simplex;
pub mod taper;
pub mod top;
pub mod turning;
pub mod written;
