"""Episodes recorded as pages to watch in a browser."""
