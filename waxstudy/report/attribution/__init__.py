"""The order-free ladder: what each modelling step adds, averaged over all orders in which the steps may be taken."""
