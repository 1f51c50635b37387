pub use rerun;
