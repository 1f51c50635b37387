// The film in 3-D.
