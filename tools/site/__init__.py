"""The site's pages: documents of this repository as they are, and what is generated from its code."""
